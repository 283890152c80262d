// A renderer backend of one's own: `backend render MODEL.lode -o frames --backend dots` draws a dot for every vertex.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include "lodestone/lodestone.h"

using namespace lodestone;

namespace {

class Dots final : public Renderer {
 public:
  [[nodiscard]] std::string_view name() const override { return "dots"; }

  using Renderer::upload;
  void upload(std::span<const Hierarchy* const> models) override { models_.assign(models.begin(), models.end()); }

  FrameStats draw(const Frame& frame) override {
    check_frame(frame, 16384);  // throws for a frame that no backend draws
    const auto pixels = static_cast<std::size_t>(frame.size.width) * static_cast<std::size_t>(frame.size.height);
    image_ = {frame.size, std::vector<std::uint8_t>(4 * pixels, 255), std::vector<float>(pixels, 1.0f)};
    FrameStats stats;
    for (const ModelFrame& drawn : frame.models)
      for (const SelectedCell& selected : drawn.selection->cells) {
        if (!selected.visible) continue;
        const Cell& cell = models_[drawn.model]->cells[selected.cell];
        ++stats.cells;
        stats.triangles += cell.triangles.size();
        positions_.resize(cell.positions.size());
        morph_cell(drawn.morph, selected.cell, positions_);
        for (const Vec3f p : positions_) draw_dot(drawn.view_projection, p);
      }
    return stats;
  }

  [[nodiscard]] Image read_back() override { return image_; }

 private:
  void draw_dot(const ViewProjection& projection, Vec3f p) {
    const auto row = [&](std::size_t r) {
      const float* const m = &projection.m[4 * r];
      return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
    };
    const float w = row(3);
    if (w <= 0) return;
    const float x = (0.5f + 0.5f * row(0) / w) * static_cast<float>(image_.size.width);
    const float y = (0.5f - 0.5f * row(1) / w) * static_cast<float>(image_.size.height);
    const float depth = 0.5f + 0.5f * row(2) / w;
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(image_.size.width) && y < static_cast<float>(image_.size.height)))
      return;
    const std::size_t at =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.size.width) + static_cast<std::size_t>(x);
    if (depth >= image_.depth[at]) return;
    image_.depth[at] = depth;
    const auto grey = static_cast<std::uint8_t>(std::clamp(255 * depth, 0.0f, 200.0f));
    std::fill_n(image_.rgba.begin() + static_cast<std::ptrdiff_t>(4 * at), 3, grey);
  }

  std::vector<const Hierarchy*> models_;
  std::vector<Vec3f> positions_;
  Image image_;
};

}  // namespace

int main(int argc, char** argv) try {
  add_backend("dots", {.frames = [](Scheduler&) { return std::make_unique<Dots>(); }, .maps = {}});
  return run_program(argc, argv);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
