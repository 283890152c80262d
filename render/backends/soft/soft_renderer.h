// The software backend: a tiled rasterizer on the scheduler's workers. Needs no graphics driver, and draws the same
// bytes for any number of threads.
#pragma once

#include <memory>

#include "parallel/scheduler.h"
#include "render/renderer.h"

namespace lodestone {

// The scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<Renderer> make_soft_renderer(Scheduler& scheduler);

}  // namespace lodestone
