// The software backend: a tiled rasterizer on the scheduler's workers. Needs no graphics driver, and draws the same
// bytes for any number of threads and any instruction set.
#pragma once

#include <memory>

#include "core/base/instruction_set.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/renderer.h"

namespace lodestone {

struct SoftConfig {
  InstructionSet instructions = InstructionSet::best;
};

// FrameStats::milliseconds: "occlusion" (with Frame::cull_occluded: finding hidden cells), "geometry" (vertices, and
// triangles into the lists of tiles), "raster" (visibility and shading by tile), "total"; wall time.
//
// The scheduler must outlive the renderer. Throws UnsupportedError where the processor lacks the instruction set.
[[nodiscard]] std::unique_ptr<Renderer> make_soft_renderer(Scheduler& scheduler, const SoftConfig& config = {});

}  // namespace lodestone
