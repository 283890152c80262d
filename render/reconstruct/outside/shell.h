// The surface of what cannot be seen past: one closed, manifold shell around a model, however many parts it has and
// however they overlap.
//
// The points of a grid are free or solid (shell_grid.h). The surface between them is that of marching tetrahedra
// (doi1991): six to a cube, each crossed by one or two triangles. Every edge of the grid that changes sides has one
// vertex and the tetrahedra around it are crossed in one ring of triangles, so that the result is closed and manifold
// by construction, whatever the grid. A vertex lies where the free space ends on its edge and is then moved to the
// tangent plane of the sample that is nearest.
#pragma once

#include <span>

#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/merge/merge.h"
#include "render/reconstruct/report/report.h"

namespace lodestone {

// `maps`: each shows the whole model from outside; those with a near plane are not used. `spacing`: of the grid,
// normalised units. Every triangle points outward. Same bytes for any number of workers.
[[nodiscard]] MergedMesh make_shell(std::span<const PositionMap> maps, double spacing, ShellReport& report,
                                    Scheduler& scheduler);

}  // namespace lodestone
