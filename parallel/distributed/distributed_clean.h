// Cleaning and welding with the vertices and triangles of the input dealt out to the ranks: the same repairs and
// numbers as core/mesh/clean.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/key_numbers.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/clean/find_repeats.h"
#include "parallel/clean/stream_clean.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/messages/slices.h"
#include "parallel/distributed/rank_input.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// The clean mesh as a rank keeps it: its slices of the input.
struct CleanSlices {
  Slices vertices, triangles;          // of the input
  std::vector<Vec3f> positions;        // by vertex of the slice; the origin for those that are not used
  std::vector<std::uint32_t> numbers;  // by vertex of the slice: what it has become, among those left of all ranks
  std::vector<std::uint8_t> left;      // by vertex of the slice: 1 if it is one of those
  BitSet dropped;                      // by triangle of the slice
  std::uint64_t own_triangles = 0;     // left in the slice
  Slices vertices_left;                // by number
  std::uint64_t triangles_left = 0;    // of all ranks
  Transform transform;
  Repairs repairs;  // of all ranks
};

// Called by all ranks with the same input and lattice (none, or one). The slice is read three to six times. Memory: 19
// bytes per vertex of the slice and a bit per triangle, and in addition first 16 bytes per vertex, then 16 per
// triangle, of a share that is as large as the slice on average. Of a slice of more than `most_items` of them at most
// so many are compared at a time, for which the slice's positions or triangles are looked at again each time.
// Throws as prepare_mesh and the stream do.
[[nodiscard]] CleanSlices distributed_clean(const RankInput& input, Lattice lattice, Ranks& ranks, Scheduler& scheduler,
                                            std::uint64_t most_items = all_in_memory);

// The distinct corners of a piece of triangles: corner k of triangle t is number(3 t + k) of them.
class PieceCorners {
 public:
  explicit PieceCorners(std::span<const Triangle> triangles);
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return numbers_.keys(); }
  [[nodiscard]] const Triangle& of(std::size_t t) const { return local_[t]; }  // by index in vertices()

 private:
  KeyNumbers<std::uint32_t> numbers_;
  std::vector<Triangle> local_;
};

}  // namespace lodestone
