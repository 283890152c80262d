// Fewer triangles for a merged mesh: more where the surface bends, fewer where it is flat.
//
// Pixels sample a flat wall as densely as an ear. Drawn finer than asked for and simplified by quadrics (garland1997)
// to as many triangles as were asked for, the same triangles come several times nearer (docs/decisions/0020). The mesh
// is cut into cubes that are simplified at once, their common vertices held in place; in a second pass the cubes are
// shifted by half of their side, and what was held goes, too.
#pragma once

#include <cstddef>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge.h"

namespace lodestone {

struct SimplifyMergedConfig {
  std::size_t triangles = 0;  // to end with; a little more where the surface allows no fewer
  float farthest = 1;         // that a vertex may be from the one that it becomes, normalised units; > 0
  // About so many in a cube, which is what a task simplifies.
  std::size_t cube_triangles = 50'000;
};

// `wedges`: of the mesh's vertices, or empty; they are simplified with it, charts stay apart, and what a vertex has
// when it has moved is that of the place. Manifold and closed where the mesh was. Same bytes for any number of workers.
void simplify_merged(MergedMesh& mesh, RawWedges& wedges, const SimplifyMergedConfig& config, Scheduler& scheduler);

}  // namespace lodestone
