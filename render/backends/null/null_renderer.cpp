#include "render/backends/null/null_renderer.h"

#include <cassert>
#include <chrono>
#include <limits>

namespace lodestone {
namespace {

class NullRenderer final : public Renderer {
 public:
  [[nodiscard]] std::string_view name() const override { return "null"; }

  void upload(const Hierarchy& hierarchy) override { hierarchy_ = &hierarchy; }

  FrameStats draw(const Frame& frame) override {
    assert(hierarchy_ && frame.selection);
    check_frame(frame, std::numeric_limits<int>::max());
    const auto start = std::chrono::steady_clock::now();
    FrameStats stats;
    for (const SelectedCell& selected : frame.selection->cells) {
      if (!selected.visible) continue;
      ++stats.cells;
      stats.triangles += hierarchy_->cells[selected.cell].triangles.size();
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    stats.milliseconds["total"] = elapsed.count();
    return stats;
  }

  [[nodiscard]] Image read_back() override { return {{0, 0}, {}, {}}; }

 private:
  const Hierarchy* hierarchy_ = nullptr;
};

}  // namespace

std::unique_ptr<Renderer> make_null_renderer() { return std::make_unique<NullRenderer>(); }

}  // namespace lodestone
