// Splitting over-long edges with several workers: core/mesh/refine.h says what that does; the same bytes.
#pragma once

#include "core/mesh/refine.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Every triangle and vertex is looked at in parallel; what is split, few triangles of most meshes, by one worker.
RefineReport refine_mesh(IndexedMesh& mesh, double longest, Scheduler& scheduler);

}  // namespace lodestone
