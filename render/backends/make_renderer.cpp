#include "render/backends/make_renderer.h"

#include <string>

#include "core/base/error.h"
#include "render/backends/null/null_renderer.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/position_map/rasterize_map.h"
#if LODESTONE_GL
#include "render/backends/gl/gl_position_map.h"
#include "render/backends/gl/gl_renderer.h"
#endif

namespace lodestone {
namespace {

class SoftMapRenderer final : public MapRenderer {
 public:
  SoftMapRenderer(const IndexedMesh& mesh, Scheduler& scheduler) : mesh_(mesh), scheduler_(scheduler) {}
  PositionMap draw(const MapView& view, MapChannels channels) override {
    return rasterize_map(mesh_, view, channels, scheduler_);
  }

 private:
  const IndexedMesh& mesh_;
  Scheduler& scheduler_;
};

}  // namespace

std::unique_ptr<Renderer> make_renderer(std::string_view backend, Scheduler& scheduler) {
  if (backend == "soft") return make_soft_renderer(scheduler);
  if (backend == "null") return make_null_renderer();
  if (backend == "gl") {
#if LODESTONE_GL
    GlConfig config;
    config.scheduler = &scheduler;
    return make_gl_renderer(config);
#else
    throw UnsupportedError("the gl backend was left out of this build; configure with LODESTONE_GL=ON, or use soft");
#endif
  }
  throw InputError("unknown backend '" + std::string(backend) + "'; known are soft, gl, null");
}

std::unique_ptr<MapRenderer> make_map_renderer(std::string_view backend, const IndexedMesh& mesh,
                                               Scheduler& scheduler) {
  if (backend == "soft") return std::make_unique<SoftMapRenderer>(mesh, scheduler);
  if (backend == "gl") {
#if LODESTONE_GL
    return make_gl_map_renderer(mesh, scheduler);
#else
    throw UnsupportedError("--backend gl: this program was built without OpenGL; use --backend soft");
#endif
  }
  throw InputError("unknown backend '" + std::string(backend) + "'; position maps are drawn by soft and gl");
}

}  // namespace lodestone
