#include "render/backends/null/null_renderer.h"

#include <cassert>
#include <chrono>
#include <limits>

namespace lodestone {
namespace {

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

}  // namespace

std::unique_ptr<Renderer> make_null_renderer() { return std::make_unique<NullRenderer>(); }

}  // namespace lodestone
