// The triangles of a frame as one mesh: those of all selected cells, culled or not, every vertex where it is drawn.
#pragma once

#include <vector>

#include "core/math/vec3.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

// Cells keep their own copies of shared vertices: equal positions are equal floats, held in double.
struct DrawnMesh {
  std::vector<Vec3d> positions;  // normalised
  std::vector<Triangle> triangles;
};

// Throws ResourceError for 2^32 or more vertices. 24 bytes a vertex, 12 a triangle.
[[nodiscard]] DrawnMesh drawn_mesh(const MorphContext& context, const Selection& selection);

// M_L.
[[nodiscard]] DrawnMesh finest_mesh(const Hierarchy& hierarchy);

}  // namespace lodestone
