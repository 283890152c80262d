#include "render/renderer.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "render/backends/null/null_renderer.h"
#include "render/backends/soft/soft_renderer.h"
#if LODESTONE_GL
#include "render/backends/gl/gl_renderer.h"
#endif

namespace lodestone {

void check_frame(const Frame& frame, int largest_side) {
  const auto [width, height] = frame.size;
  if (width < 1 || height < 1 || width > largest_side || height > largest_side)
    throw InputError("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels is out of range; this backend draws 1 to " + std::to_string(largest_side) + " a side");
  if (frame.samples != 1 && frame.samples != 4)
    throw InputError("a pixel has 1 or 4 samples, not " + std::to_string(frame.samples));
  const bool finite = std::ranges::all_of(frame.view_projection.m, [](float v) { return std::isfinite(v); });
  if (!finite || !is_finite(frame.morph.viewpoint) || !is_finite(frame.light))
    throw InputError(describe("", "the frame", "matrix, viewpoint and light must be finite numbers"));
}

std::unique_ptr<Renderer> make_renderer(std::string_view backend, Scheduler& scheduler) {
  if (backend == "soft") return make_soft_renderer(scheduler);
  if (backend == "null") return make_null_renderer();
  if (backend == "gl") {
#if LODESTONE_GL
    return make_gl_renderer();
#else
    throw UnsupportedError("the gl backend was left out of this build; configure with LODESTONE_GL=ON, or use soft");
#endif
  }
  throw InputError("unknown backend '" + std::string(backend) + "'; known are soft, gl, null");
}

}  // namespace lodestone
