// The steps of core/mesh/clean.h for one chunk of vertices or triangles, or for one bucket of hashed items: what
// prepare_mesh (parallel/clean/prepare.h) runs side by side. Each may be called at once on disjoint chunks or buckets.
//
// A triangle that goes is overwritten by (0, 0, 0), which is degenerate, until it is squeezed out at the end: no flags
// beside the triangles, no second copy of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/clean.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class VertexState : std::uint8_t { unused, used, not_finite };

// Vertices: which are not finite; returns how many.
std::uint64_t classify_vertices(std::span<const Vec3d> positions, std::span<VertexState> states);

// Triangles: marks the corners of those whose corners are all finite as used, and drops the others; returns how many.
// `states` is of all vertices.
[[nodiscard]] std::uint64_t drop_non_finite(std::span<Triangle> triangles, std::span<VertexState> states);

// The same where all are finite.
void mark_corners(std::span<const Triangle> triangles, std::span<VertexState> states);

// Vertices: grows the box around those in use.
void extend_box(std::span<const Vec3d> positions, std::span<const VertexState> states, Box3d& box);

// Vertices: the origin for those not in use.
void normalise_vertices(const Transform& transform, std::span<const Vec3d> positions,
                        std::span<const VertexState> states, std::span<Vec3f> out);

// Well-mixed hashes of the bits of a position, and of a triangle whatever corner it begins with.
[[nodiscard]] std::uint64_t hash_of(Vec3f position);
[[nodiscard]] std::uint64_t hash_of(const Triangle& triangle);

// One of the items that are searched for equals: half of its hash, and its number.
struct HashedItem {
  std::uint32_t hash = 0;
  std::uint32_t index = 0;
};

// Finds equal items in a bucket. Memory: 16 to 32 bytes per item of the largest bucket, kept from one to the next.
class RepeatFinder {
 public:
  // Calls found(repeat, first) for every item that equals(repeat, first) an earlier one, in the order of the bucket;
  // `first` is the earliest of its equals. Linear in the size of the bucket.
  template <class Equals, class Found>
  void find(std::span<const HashedItem> bucket, const Equals& equals, const Found& found);

 private:
  std::vector<HashedItem> slots_;  // open addressing, at most half full
};

// Triangles: replaces corners by representatives and drops the degenerate; returns how many are now degenerate.
[[nodiscard]] std::uint64_t weld_triangles(std::span<const std::uint32_t> representative,
                                           std::span<Triangle> triangles);

// The same where each vertex is its own.
[[nodiscard]] std::uint64_t drop_degenerate(std::span<Triangle> triangles);

// Triangles: marks the corners of those that are left as used.
void mark_used(std::span<const Triangle> triangles, std::span<VertexState> states);

// Vertices: moves those in use to the front, in order, and returns how many; numbers[i] = first + the new place of i.
[[nodiscard]] std::size_t squeeze_vertices(std::span<const VertexState> states, std::span<Vec3f> positions);
void number_vertices(std::span<const VertexState> states, std::uint32_t first, std::span<std::uint32_t> numbers);

// Triangles: renumbers the corners of those that are left, moves them to the front, in order, and returns how many.
[[nodiscard]] std::size_t squeeze_triangles(std::span<const std::uint32_t> numbers, std::span<Triangle> triangles);

template <class Equals, class Found>
void RepeatFinder::find(std::span<const HashedItem> bucket, const Equals& equals, const Found& found) {
  constexpr std::uint32_t empty = 0xFFFFFFFF;
  std::size_t capacity = 16;
  while (capacity < 2 * bucket.size()) capacity *= 2;
  slots_.assign(capacity, {0, empty});
  const std::size_t mask = capacity - 1;
  for (const HashedItem& item : bucket) {
    std::size_t at = item.hash & mask;
    while (slots_[at].index != empty && !(slots_[at].hash == item.hash && equals(item.index, slots_[at].index)))
      at = (at + 1) & mask;
    if (slots_[at].index == empty) {
      slots_[at] = item;
    } else {
      found(item.index, slots_[at].index);
    }
  }
}

}  // namespace lodestone
