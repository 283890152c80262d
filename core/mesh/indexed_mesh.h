// Triangle meshes as plain data.
//
// RawMesh has the content of a file: double precision, nothing checked beyond index range. The rest of the program
// works on IndexedMesh: float32 inside the unit cube, welded and clean, with the transform back to the file's space.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/math/lattice.h"
#include "core/math/vec3.h"
#include "core/mesh/attributes.h"

namespace lodestone {

// The direction that is up in the space of a model: what cameras stand upright by, and what formats with an up axis of
// their own (glTF, 3D Tiles) are turned by. The numbers are those of .lode files. `earth`: away from the origin, which
// is the middle of the Earth.
enum class UpAxis : std::uint8_t { z, y, x, minus_z, minus_y, minus_x, earth };

// Formats that do not say which axis is up leave it to be guessed: y for OBJ, whose exporters turn models so by
// default, z for all others.
struct Up {
  UpAxis axis = UpAxis::z;
  bool guessed = true;
  friend bool operator==(const Up&, const Up&) = default;
};

struct RawMesh {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  Up up{};
  // Repairs of the reader.
  std::uint64_t polygons_triangulated = 0;  // faces of more than three corners
  std::uint64_t faces_dropped = 0;          // faces of fewer than three corners
  std::uint64_t void_posts = 0;             // of a height grid, without a height: left open
  std::uint64_t filled_posts = 0;           // of a height grid, without a height: interpolated
  // Attributes of the surface; all empty if it has none or they were not asked for.
  RawWedges wedges;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  // Parts that were left out, each as a line that names file and place: a missing texture, points or lines.
  std::vector<std::string> warnings;
};

// Zero when the mesh has no attributes.
[[nodiscard]] inline std::size_t wedge_count(const RawMesh& mesh) {
  return std::max({mesh.wedges.uv.size(), mesh.wedges.normal.size(), mesh.wedges.colour.size()});
}

// model = origin + scale * normalised; scale is the longest extent of the bounding box, so that the normalised mesh
// lies in [0,1]^3 and touches both ends of at least one axis.
struct Transform {
  Vec3d origin;
  double scale = 1;
  Lattice lattice = {};  // that every normalised vertex is on, if any
  Up up = {};            // of the model's space
  [[nodiscard]] Vec3d to_model(Vec3f p) const { return origin + scale * to_double(p); }
  [[nodiscard]] Vec3f to_normalised(Vec3d p) const { return to_float((1 / scale) * (p - origin)); }
  friend bool operator==(const Transform&, const Transform&) = default;
};

// The attributes of the wedges of an IndexedMesh; all empty without attributes.
struct WedgeAttributes {
  // By wedge: the first wedge at the same position, equal for wedges of one vertex.
  std::vector<std::uint32_t> vertex;
  std::vector<Vec2f> uv;      // finite; one per wedge, or empty
  std::vector<Rgba8> colour;  // likewise
  std::vector<Vec3f> normal;  // likewise; zero: unknown
  // Likewise: an index into materials, or no_material; the same for the three corners of a triangle, so that materials
  // meet along seams. Empty: all have the first material.
  std::vector<std::uint32_t> material;
  std::vector<Material> materials;
  std::vector<Texture> textures;
};

struct IndexedMesh {
  // Normalised, finite, in [0,1]^3. Without attributes one per vertex, pairwise different bits (welded). With
  // attributes one per wedge: wedges of one vertex have the same position, those of different vertices different ones.
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;  // into positions; three distinct vertices, no exact duplicates
  Transform transform;
  WedgeAttributes wedges{};
};

// Counts of everything that cleaning changed; all zero for a mesh that was already clean.
struct Repairs {
  std::uint64_t polygons_triangulated = 0;
  std::uint64_t faces_dropped = 0;         // fewer than three corners
  std::uint64_t non_finite_triangles = 0;  // triangles dropped because a corner is NaN or infinite
  std::uint64_t welded_vertices = 0;       // vertices merged into another one at the same position
  std::uint64_t degenerate_triangles = 0;  // two equal vertices after welding
  std::uint64_t duplicate_triangles = 0;   // same three vertices in the same cyclic order
  std::uint64_t unreferenced_vertices = 0;
  std::uint64_t void_posts = 0;    // of a height grid, without a height: left open
  std::uint64_t filled_posts = 0;  // of a height grid, without a height: interpolated
  friend bool operator==(const Repairs&, const Repairs&) = default;
};

// Counts of what splitting edges changed (core/mesh/refine.h).
struct RefineReport {
  std::uint64_t triangles_before = 0, triangles_after = 0;
  std::uint64_t split = 0;  // triangles of the mesh that had an edge beyond the limit
};

}  // namespace lodestone
