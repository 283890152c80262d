// Normals that face away from their triangles, where a fold of the source or a collapse put them.
#pragma once

#include <cstddef>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Afterwards no normal of a corner faces away from the triangle: a wedge that has such a corner takes the mean normal
// of its triangles, and where that is not enough the corner gets a wedge with the triangle's own. Triangles without
// area and unknown normals have no say. A mesh with normals that face away from most of its triangles is left alone:
// its triangles are inside out. Returns the number of corners that faced away, 0 in a mesh that is left alone.
std::size_t turn_normals(RawMesh& mesh);

}  // namespace lodestone
