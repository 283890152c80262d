#include "render/backends/make_renderer.h"

#include <cassert>
#include <chrono>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/position_map/map_renderer.h"
#include "render/position_map/rasterize_map.h"
#if LODESTONE_GL
#include "render/backends/gl/gl_position_map.h"
#include "render/backends/gl/gl_renderer.h"
#endif

namespace lodestone {
namespace {

// Draws nothing and counts what would be drawn: selection and culling at their own cost.
class NullRenderer final : public Renderer {
 public:
  [[nodiscard]] std::string_view name() const override { return "null"; }

  using Renderer::upload;
  void upload(std::span<const Hierarchy* const> models) override { models_.assign(models.begin(), models.end()); }

  FrameStats draw(const Frame& frame) override {
    check_frame(frame, std::numeric_limits<int>::max());
    const auto start = std::chrono::steady_clock::now();
    FrameStats stats;
    for (const ModelFrame& drawn : frame.models) {
      assert(drawn.model < models_.size() && drawn.selection);
      for (const SelectedCell& selected : drawn.selection->cells) {
        if (!selected.visible) continue;
        ++stats.cells;
        stats.triangles += models_[drawn.model]->cells[selected.cell].triangles.size();
      }
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    stats.milliseconds["total"] = elapsed.count();
    return stats;
  }

  [[nodiscard]] Image read_back() override { return {{0, 0}, {}, {}}; }

 private:
  std::vector<const Hierarchy*> models_;
};

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
  if (backend == "null") return std::make_unique<NullRenderer>();
  if (backend == "gl") {
#if LODESTONE_GL
    GlConfig config;
    config.scheduler = &scheduler;
    return make_gl_renderer(config);
#else
    throw UnsupportedError("the gl backend was left out of this build; configure with LODESTONE_GL=ON, or use soft");
#endif
  }
  throw InputError("unknown backend '" + std::string(backend) + "'; " + known_names(backend, {"soft", "gl", "null"}));
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
