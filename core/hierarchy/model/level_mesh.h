// One whole level of a hierarchy as a mesh of its own: for export and for measuring distances.
#pragma once

#include "core/hierarchy/model/hierarchy.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// M_l in model space (double): the copies that cells have of a shared vertex become one vertex again, vertices without
// a triangle are left out, triangles come cell by cell. Level 0 is the root, hierarchy.finest() the input up to the
// order of its vertices and triangles. With attributes the vertices of the result are wedges: `wedges` has one value of
// each attribute per vertex, normals included, and a material per triangle; textures are what the level shows. Throws
// InputError when there is no such level, ResourceError when the level has more vertices than 32 bits count.
[[nodiscard]] RawMesh level_mesh(const Hierarchy& hierarchy, int level);

}  // namespace lodestone
