// Restores sharp features that a sampled surface has lost.
//
// If two samples are on different sides of a sharp edge, the triangles between them cut it off. Following attene2005,
// every such *chamfer* edge gets a new vertex, at the nearest point where the tangent planes of its two ends meet; a
// triangle of three chamfer edges gets one more, where three planes meet. Triangles are split as in red-green
// refinement: all that share an edge split it at the same vertex, so that a manifold mesh remains manifold.
#pragma once

#include <cstddef>

#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/merge.h"
#include "render/reconstruct/report/report.h"

namespace lodestone {

struct SharpenConfig {
  float spacing = 0;      // of the samples, the unit of what follows; > 0
  float degrees = 35;     // minimum angle between the normals at the ends of a chamfer edge, in (0, 180)
  float farthest = 1.5f;  // maximum distance of a new vertex from its edge's middle, in spacings
};

// Same result for any number of workers. New vertices have view no_view and the mean of their ends' normals.
SharpenReport sharpen(MergedMesh& mesh, const SharpenConfig& config, Scheduler& scheduler);

}  // namespace lodestone
