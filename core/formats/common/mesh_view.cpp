#include "core/formats/common/mesh_view.h"

namespace lodestone {

MeshView view_of(const RawMesh& mesh) {
  return {mesh.positions.size(),
          [&mesh](std::size_t i) { return mesh.positions[i]; },
          mesh.triangles,
          mesh.wedges.corners.empty() ? &mesh.wedges : nullptr,
          mesh.materials,
          mesh.textures,
          mesh.up};
}

MeshView view_of(const IndexedMesh& mesh) {
  return {mesh.positions.size(),
          [&mesh](std::size_t i) { return mesh.transform.to_model(mesh.positions[i]); },
          mesh.triangles,
          nullptr,
          {},
          {},
          mesh.transform.up};
}

Box3d box_of(const MeshView& mesh) {
  Box3d box;
  for (std::size_t i = 0; i < mesh.vertex_count; ++i) box.extend(mesh.position(i));
  return box;
}

}  // namespace lodestone
