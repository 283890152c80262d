// Simplifiers of other libraries as they are, for whole meshes: they know no displacement bound, and only OpenMesh
// keeps locked vertices.
//
// One translation unit each: their headers take a minute to compile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct PeerMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> locked;  // one per position, or empty: nothing is locked
};

// Quadrics and half-edge collapses (DecimaterT with ModQuadricT and ModNormalFlippingT), an exact heap, one thread.
// Faces that its half-edges cannot hold get vertices of their own, as its readers do it.
[[nodiscard]] PeerMesh simplify_with_openmesh(const PeerMesh& mesh, std::size_t triangles);

// Quadrics and half-edge collapses in passes. Locks the border when anything is locked, else nothing.
[[nodiscard]] PeerMesh simplify_with_meshoptimizer(const PeerMesh& mesh, std::size_t triangles);

// Vertex clustering on a grid, topology not kept.
[[nodiscard]] PeerMesh cluster_with_meshoptimizer(const PeerMesh& mesh, std::size_t triangles);

// meshoptimizer's voxel remesher, which came with version 1.2: false where the library is older.
[[nodiscard]] bool has_meshoptimizer_remesher();
// A surface of `voxels` along the longest side, 4 to 256 (others are clamped). Throws Error where there is no remesher.
[[nodiscard]] PeerMesh remesh_with_meshoptimizer(const PeerMesh& mesh, int voxels);

}  // namespace lodestone
