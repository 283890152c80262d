#include "render/backends/make_renderer.h"

#include <cassert>
#include <chrono>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/base/registry.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/position_map/position_map.h"
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
        stats.triangles += drawn_triangles(models_[drawn.model]->cells[selected.cell], selected.ranges);
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

std::unique_ptr<Renderer> gl_frames(Scheduler& scheduler) {
#if LODESTONE_GL
  GlConfig config;
  config.scheduler = &scheduler;
  return make_gl_renderer(config);
#else
  (void)scheduler;
  throw UnsupportedError("the gl backend was left out of this build; configure with LODESTONE_GL=ON, or use soft");
#endif
}

std::unique_ptr<MapRenderer> gl_maps(const IndexedMesh& mesh, Scheduler& scheduler) {
#if LODESTONE_GL
  return make_gl_map_renderer(mesh, scheduler);
#else
  (void)mesh, (void)scheduler;
  throw UnsupportedError("the gl backend was left out of this build; configure with LODESTONE_GL=ON, or use soft");
#endif
}

Registry<BackendInfo>& backends() {
  static Registry<BackendInfo> all = [] {
    Registry<BackendInfo> ours("backend");
    ours.add("soft", {.frames = [](Scheduler& scheduler) { return make_soft_renderer(scheduler); },
                      .maps = [](const IndexedMesh& mesh,
                                 Scheduler& scheduler) { return std::make_unique<SoftMapRenderer>(mesh, scheduler); }});
    ours.add("gl", {.frames = gl_frames, .maps = gl_maps});
    ours.add("null",
             {.frames = [](Scheduler&) { return std::make_unique<NullRenderer>(); }, .maps = {}, .pictures = false});
    return ours;
  }();
  return all;
}

template <class Fits>
std::vector<std::string> names_where(const Fits& fits) {
  std::vector<std::string> names;
  for (const std::string& name : backends().names())
    if (fits(backends().at(name))) names.push_back(name);
  return names;
}

}  // namespace

void add_backend(const std::string& name, BackendInfo info) {
  if (!info.frames && !info.maps) throw InputError("backend '" + name + "' draws neither frames nor maps");
  backends().add(name, std::move(info));
}

std::vector<std::string> backend_names() {
  return names_where([](const BackendInfo& info) { return static_cast<bool>(info.frames); });
}

std::vector<std::string> picture_backend_names() {
  return names_where([](const BackendInfo& info) { return info.frames && info.pictures; });
}

std::vector<std::string> map_backend_names() {
  return names_where([](const BackendInfo& info) { return static_cast<bool>(info.maps); });
}

std::unique_ptr<Renderer> make_renderer(std::string_view backend, Scheduler& scheduler) {
  const BackendInfo& info = backends().at(backend);
  if (info.frames) return info.frames(scheduler);
  throw InputError("backend '" + std::string(backend) + "' draws no frames; " + known_names(backend, backend_names()));
}

std::unique_ptr<MapRenderer> make_map_renderer(std::string_view backend, const IndexedMesh& mesh,
                                               Scheduler& scheduler) {
  const BackendInfo& info = backends().at(backend);
  if (info.maps) return info.maps(mesh, scheduler);
  throw InputError("backend '" + std::string(backend) + "' draws no position maps; " +
                   known_names(backend, map_backend_names()));
}

}  // namespace lodestone
