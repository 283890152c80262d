// Simplifies a merged mesh: more triangles where the surface bends, fewer where it is flat.
//
// Pixels sample a flat wall as densely as an ear. Drawn finer than requested and simplified by quadrics (garland1997)
// to the requested number of triangles, the mesh is several times more accurate (docs/decisions/0020). It is cut into
// cubes that are simplified in parallel, their common vertices locked; in a second pass the cubes are shifted by half
// of their side, so that vertices locked before are simplified, too.
#pragma once

#include <cstddef>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/merge.h"

namespace lodestone {

struct SimplifyMergedConfig {
  std::size_t triangles = 0;  // to end with; a little more where the surface allows no fewer
  float farthest = 1;         // that a vertex may be from the one that it becomes, normalised units; > 0
  // About so many in a cube, which is what a task simplifies.
  std::size_t cube_triangles = 12'500;
};

// `wedges`: those of the mesh's vertices, or empty; they are simplified with it, charts remain separate, and a moved
// vertex takes the values of its new place. Manifold and closed if the mesh was. Gives the same bytes for any number of
// workers.
void simplify_merged(MergedMesh& mesh, RawWedges& wedges, const SimplifyMergedConfig& config, Scheduler& scheduler);

}  // namespace lodestone
