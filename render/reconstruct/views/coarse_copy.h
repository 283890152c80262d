// A coarse copy of a mesh: what decides which views see which part of a model does not need triangles smaller than the
// pixels of those views.
#pragma once

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Vertices in one cell of a grid become their mean (rossignac1993); triangles with corners in fewer than three cells
// are left out. Positions and triangles only. cell: normalised units, at least 1e-6. Linear time; memory: 4 bytes per
// vertex and 48 per cell.
[[nodiscard]] IndexedMesh coarse_copy(const IndexedMesh& mesh, double cell);

}  // namespace lodestone
