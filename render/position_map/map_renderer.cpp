#include "render/position_map/map_renderer.h"

#include <string>

#include "core/base/error.h"
#include "render/position_map/rasterize_map.h"
#ifdef LODESTONE_GL
#include "render/backends/gl/gl_position_map.h"
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

std::unique_ptr<MapRenderer> make_map_renderer(std::string_view backend, const IndexedMesh& mesh,
                                               Scheduler& scheduler) {
  if (backend == "soft") return std::make_unique<SoftMapRenderer>(mesh, scheduler);
  if (backend == "gl") {
#ifdef LODESTONE_GL
    return make_gl_map_renderer(mesh, scheduler);
#else
    throw UnsupportedError("--backend gl: this program was built without OpenGL; use --backend soft");
#endif
  }
  throw InputError("unknown backend '" + std::string(backend) + "'; position maps are drawn by soft and gl");
}

}  // namespace lodestone
