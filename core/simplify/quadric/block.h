// The state of one block under simplification: what every step of the kernel reads and changes.
#pragma once

#include <algorithm>
#include <bit>

#include "core/simplify/quadric/nonmanifold_stars.h"
#include "core/simplify/quadric/ring_lanes.h"
#include "core/simplify/quadric/seams.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// A cost is an error over weight^(3/4): between the sum of the squared distances, which asks what a collapse adds to
// the error of the whole mesh, and their mean, which does not tell a large star from a small one (decision 0013).
// Buckets are logarithms, and so, nearly, are the bits of a float: nothing has to be divided.
inline std::int64_t scale_of(float weight) {
  const auto over_one = std::int64_t{std::bit_cast<std::uint32_t>(weight)} - 0x3f80'0000;
  return over_one - (over_one >> 2);
}
inline unsigned bucket_of(float error, std::int64_t scale) {
  if (!(error > 0)) return 0;
  const std::int64_t over_scale = std::int64_t{std::bit_cast<std::uint32_t>(error)} - scale;
  return static_cast<unsigned>(std::clamp<std::int64_t>(over_scale, 0, 0x7fff'ffff) >> bucket_shift);
}

struct Block {
  const SimplifyInput& input;
  Arrays& a;
  NonmanifoldStars& stars;  // of the vertices that are not manifold
  Seams* seams;             // null for a mesh without wedges
  SimplifyResult& result;
  unsigned count;                      // vertices
  float scale = 1;                     // from input coordinates to those of the block, a power of two
  float bound = 0, squared_bound = 0;  // in block coordinates
  std::size_t live = 0;                // triangles
  std::size_t movable_fans = 0;        // in the input
  std::size_t movable_corners = 0;     // triangles of the nonmanifold vertices that may move
  bool stars_move = false;             // some nonmanifold vertices may move

  [[nodiscard]] unsigned degree(Id v) const { return Id16::load(a.ring[v].lane).find(none); }

  void push(Id v, unsigned bucket) {
    a.next_in_bucket[v] = a.bucket[bucket];
    a.bucket[bucket] = v;
  }
  void leave_queue(Id v) { a.ring[v].lane[flags_lane] = static_cast<Id>(a.ring[v].lane[flags_lane] & ~queued); }
  // A vertex without a valid target has left the queue; now that its ring changes it gets a new chance. Comes before
  // the ring is stored, so that the flags need not wait for that.
  void requeue(Id v, unsigned bucket) {
    Id& flags = a.ring[v].lane[flags_lane];
    if ((flags & (movable | queued)) != movable) return;
    flags |= queued;
    push(v, bucket);
  }
};

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
