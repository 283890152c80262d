// The vertices of a mesh with and without wedges.
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// The first wedge at the position of one; in a mesh without attributes the vertex itself.
[[nodiscard]] inline std::uint32_t vertex_of(const IndexedMesh& mesh, std::uint32_t wedge) {
  return mesh.wedges.vertex.empty() ? wedge : mesh.wedges.vertex[wedge];
}

}  // namespace lodestone
