// The steps of core/mesh/clean.h for one chunk of vertices or triangles, or for one bucket of hashed items;
// prepare_mesh (parallel/clean/prepare.h) runs them in parallel. All may be called at once on disjoint chunks or
// buckets.
//
// A dropped triangle is overwritten by (0, 0, 0), which is degenerate, and removed at the end: this needs no flags
// beside the triangles and no second copy of them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/key_numbers.h"
#include "core/mesh/clean.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class VertexState : std::uint8_t { unused, used, not_finite };

// Vertices: finds those that are not finite; returns their number.
std::uint64_t classify_vertices(std::span<const Vec3d> positions, std::span<VertexState> states);

// Triangles: marks the corners of those whose corners are all finite as used, and drops the others; returns the
// number dropped. `states` has all vertices.
[[nodiscard]] std::uint64_t drop_non_finite(std::span<Triangle> triangles, std::span<VertexState> states);

// The same if all are finite.
void mark_corners(std::span<const Triangle> triangles, std::span<VertexState> states);

// Vertices: grows the box around those in use.
void extend_box(std::span<const Vec3d> positions, std::span<const VertexState> states, Box3d& box);

// Vertices: normalises those in use; the others become the origin.
void normalise_vertices(const Transform& transform, std::span<const Vec3d> positions,
                        std::span<const VertexState> states, std::span<Vec3f> out);

// Well-mixed hashes of the bits of a position, and of a triangle independently of its first corner.
[[nodiscard]] std::uint64_t hash_of(Vec3f position);
[[nodiscard]] std::uint64_t hash_of(const Triangle& triangle);

// An item of a search for equal ones: half of its hash, and its number.
struct HashedItem {
  std::uint32_t hash = 0;
  std::uint32_t index = 0;
};

// Finds equal items in a bucket. Memory: 16 to 32 bytes per item of the largest bucket, kept from one to the next.
class RepeatFinder {
 public:
  // Calls found(repeat, first), in the order of the bucket, for every item for which equals(repeat, first) holds with
  // an earlier one; `first` is the earliest of them. Linear in the size of the bucket.
  template <class Equals, class Found>
  void find(std::span<const HashedItem> bucket, const Equals& equals, const Found& found);

 private:
  std::vector<HashedItem> slots_;  // open addressing, at most half full
};

// Triangles: replaces corners by representatives and drops the degenerate; returns the number dropped.
[[nodiscard]] std::uint64_t weld_triangles(std::span<const std::uint32_t> representative,
                                           std::span<Triangle> triangles);

// The same if no vertices are merged.
[[nodiscard]] std::uint64_t drop_degenerate(std::span<Triangle> triangles);

// Triangles: marks the corners of the remaining ones as used.
void mark_used(std::span<const Triangle> triangles, std::span<VertexState> states);

// Vertices: moves those in use to the front, in order, and returns their number; numbers[i] = first + the new place of
// i.
[[nodiscard]] std::size_t compact_vertices(std::span<const VertexState> states, std::span<Vec3f> positions);
void number_vertices(std::span<const VertexState> states, std::uint32_t first, std::span<std::uint32_t> numbers);

// Triangles: renumbers the corners of the remaining ones, moves them to the front, in order, and returns their number.
[[nodiscard]] std::size_t compact_triangles(std::span<const std::uint32_t> numbers, std::span<Triangle> triangles);

template <class Equals, class Found>
void RepeatFinder::find(std::span<const HashedItem> bucket, const Equals& equals, const Found& found) {
  constexpr std::uint32_t empty = 0xFFFFFFFF;
  slots_.assign(std::bit_ceil(std::max<std::size_t>(16, 2 * bucket.size())), {0, empty});
  for (const HashedItem& item : bucket) {
    HashedItem& slot = probe(slots_.data(), slots_.size() - 1, item.hash, [&](const HashedItem& known) {
      return known.index == empty || (known.hash == item.hash && equals(item.index, known.index));
    });
    if (slot.index == empty) {
      slot = item;
    } else {
      found(item.index, slot.index);
    }
  }
}

}  // namespace lodestone
