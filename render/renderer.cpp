#include "render/renderer.h"

#include "core/base/error.h"
#include "render/backends/null/null_renderer.h"
#include "render/backends/soft/soft_renderer.h"
#if LODESTONE_GL
#include "render/backends/gl/gl_renderer.h"
#endif

namespace lodestone {

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
