// Splitting over-long edges with several workers: core/mesh/refine.h says what that does; the same bytes.
#pragma once

#include "core/mesh/refine.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Looks at all triangles and vertices in parallel; one worker splits, as few triangles of most meshes need it.
RefineReport refine_mesh(IndexedMesh& mesh, double longest, Scheduler& scheduler);

}  // namespace lodestone
