// A mesh to be written, wherever it is stored.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Positions are in the space of the file.
struct MeshView {
  std::size_t vertex_count = 0;
  std::function<Vec3d(std::size_t)> position;
  std::span<const Triangle> triangles;
  // Attributes by vertex, for formats that have them; null: none.
  const RawWedges* wedges = nullptr;
  std::span<const Material> materials{};
  std::span<const Texture> textures{};
  Up up{};  // of the space of the file
};

// The mesh has to outlive its view. Wedges that are not the vertices are left out.
[[nodiscard]] MeshView view_of(const RawMesh& mesh);
[[nodiscard]] MeshView view_of(const IndexedMesh& mesh);  // in the space of the file that it was read from

// Box of all vertices; empty when there are none.
[[nodiscard]] Box3d box_of(const MeshView& mesh);

}  // namespace lodestone
