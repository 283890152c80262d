// Triangle meshes as plain data.
//
// RawMesh is what a file says: double precision, nothing checked beyond index range. IndexedMesh is what the rest of
// the program works on: float32 inside the unit cube, welded and clean, with the transform back to the file's space.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec3.h"

namespace lodestone {

// Three vertex ids, counter-clockwise seen from outside. What they index is said where a Triangle is used.
struct Triangle {
  std::array<std::uint32_t, 3> v{};
  friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

[[nodiscard]] constexpr bool is_degenerate(const Triangle& t) {
  return t.v[0] == t.v[1] || t.v[1] == t.v[2] || t.v[2] == t.v[0];
}

struct RawMesh {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  // What the reader had to do to make sense of the file.
  std::uint64_t polygons_triangulated = 0;  // faces of more than three corners
  std::uint64_t faces_dropped = 0;          // faces of fewer than three corners
};

// model = origin + scale * normalised; scale is the longest extent of the bounding box, so that the normalised mesh
// lies in [0,1]^3 and touches both ends of at least one axis.
struct Transform {
  Vec3d origin;
  double scale = 1;
  [[nodiscard]] Vec3d to_model(Vec3f p) const { return origin + scale * to_double(p); }
  [[nodiscard]] Vec3f to_normalised(Vec3d p) const { return to_float((1 / scale) * (p - origin)); }
  friend bool operator==(const Transform&, const Transform&) = default;
};

struct IndexedMesh {
  std::vector<Vec3f> positions;     // normalised, finite, in [0,1]^3, pairwise different bits (welded)
  std::vector<Triangle> triangles;  // into positions; three distinct ids, no exact duplicates
  Transform transform;
};

// Counts of everything that cleaning changed; all zero for a mesh that was already sound.
struct Repairs {
  std::uint64_t polygons_triangulated = 0;
  std::uint64_t faces_dropped = 0;         // fewer than three corners
  std::uint64_t non_finite_triangles = 0;  // triangles dropped because a corner is NaN or infinite
  std::uint64_t welded_vertices = 0;       // vertices merged into another one at the same position
  std::uint64_t degenerate_triangles = 0;  // two equal vertices after welding
  std::uint64_t duplicate_triangles = 0;   // same three vertices in the same cyclic order
  std::uint64_t unreferenced_vertices = 0;
  friend bool operator==(const Repairs&, const Repairs&) = default;
};

}  // namespace lodestone
