// A progressive mesh (hoppe1996) on one parent index per vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// An image of positions: PNG of 16 bits per component. Model position = origin + step * value.
struct GeometryTexture {
  std::uint32_t texture = no_texture;
  Vec3d origin;
  double step = 1;  // greater than 0
  friend bool operator==(const GeometryTexture&, const GeometryTexture&) = default;
};

// So many squares of equal sides, powers of two in texels.
struct SquareRun {
  std::uint32_t side = 0, count = 0;
  friend bool operator==(const SquareRun&, const SquareRun&) = default;
};

// Without squares: one image. With squares: an atlas of small ones (core/spherical/octahedron/square_atlas.h), a power
// of two along its side. Its squares follow each other along a Morton curve, larger ones first. Images of the same
// layout may have other sizes: all lengths are in proportion.
struct OctahedralLayout {
  std::uint32_t side = 0;  // of an atlas, texels
  std::vector<SquareRun> squares{};
  friend bool operator==(const OctahedralLayout&, const OctahedralLayout&) = default;
};

// Vertices are stored in the order in which they come in: a level is the first so many of them, and the triangles with
// every corner followed through its parents until it is among them, degenerate ones dropped. A vertex of the surface is
// a *group* of consecutive vertices of equal position, one per wedge, which come in together.
//
// Triangles are stored in the order in which they come in, too: the first so many of them are those of a level, which
// are not degenerate, nor of flaps smaller than its error (flaps.h).
struct ProgressiveMesh {
  std::vector<Vec3f> positions;        // normalised, as of IndexedMesh
  std::vector<std::uint32_t> parents;  // parents[v] < v; 0 in the base, whose vertices have none
  // Estimated distance of the mesh from the input while v is missing, by the metric that ranked the collapses:
  // normalised, the same for all of a group, never more than that of the vertex before. In the base, that of the base
  // itself. parallel/progressive/level_errors.h measures.
  std::vector<float> errors;
  std::vector<Triangle> triangles;  // of the finest level
  double finest_error = 0;          // bound of the distance of the finest level from the input, both ways; normalised
  std::uint32_t base_vertices = 0;
  Transform transform;
  WedgeAttributes wedges{};  // by vertex; `vertex` is empty
  // By material: the texture of its normals in object space, which are right at every level, each coordinate from -1 to
  // 1 as a byte; or no_texture. Empty if none has one.
  std::vector<std::uint32_t> object_normals{};
  // By material: its surface as a geometry image (core/spherical/resample/geometry_image.h), or one without a texture.
  // Empty if none has one.
  std::vector<GeometryTexture> geometry_images{};
  // By vertex, for normal maps in tangent space at the finest level. Empty: readers make their own.
  std::vector<Tangent> tangents{};
  // By material: how its images lie over octahedral squares, which a renderer must make seamless after decoding, and at
  // each mip level (core/spherical/octahedron/octahedral_image.h, square_atlas.h). Empty if none do.
  std::vector<std::optional<OctahedralLayout>> octahedral{};

  [[nodiscard]] std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(positions.size()); }
};

// Checks all that the struct above promises, except the values of attributes: throws InputError with the place.
void check_progressive(const ProgressiveMesh& mesh, const std::string& name);

}  // namespace lodestone
