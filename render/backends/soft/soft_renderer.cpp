// Sort-middle rendering (Molnar et al. 1994): vertices by cell, triangles by batch of cells, pixels by tile. How work
// is cut depends on the scene alone, and each stage writes to places of its own: no locks, the same bytes for any
// number of threads.
#include "render/backends/soft/soft_renderer.h"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "core/base/error.h"
#include "render/backends/soft/bin_stage.h"
#include "render/backends/soft/tile_stage.h"
#include "render/backends/soft/vertex_stage.h"

namespace lodestone {
namespace soft {
namespace {

// Enough triangles to be worth a task, few enough for every worker to get several.
constexpr std::size_t triangles_per_batch = 8192;

class Stopwatch {
 public:
  // Milliseconds since the last call, or since construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

class SoftRenderer final : public Renderer {
 public:
  explicit SoftRenderer(Scheduler& scheduler)
      : scheduler_(scheduler), workers_(static_cast<std::size_t>(scheduler.workers())) {}

  [[nodiscard]] std::string_view name() const override { return "soft"; }
  void upload(const Hierarchy& hierarchy) override { hierarchy_ = &hierarchy; }
  [[nodiscard]] Image read_back() override { return image_; }

  FrameStats draw(const Frame& frame) override {
    assert(hierarchy_ && frame.selection && frame.morph.hierarchy == hierarchy_);
    Stopwatch stage, total;
    FrameStats stats;
    resize(frame.size);
    gather(*frame.selection, stats);
    const Viewport viewport(frame.size);
    const TileGrid grid(frame.size);
    transform(frame, viewport);
    stats.milliseconds["morph"] = stage.lap();
    bin(frame, viewport, grid);
    stats.milliseconds["bin"] = stage.lap();
    rasterize(frame, grid);
    stats.milliseconds["raster"] = stage.lap();
    stats.milliseconds["total"] = total.lap();
    return stats;
  }

 private:
  // One per worker; reused between frames.
  struct Workplace {
    MorphScratch morph;
    BinScratch bin;
    std::unique_ptr<TileScratch> tile = std::make_unique<TileScratch>();
  };

  Workplace& workplace() { return workers_[static_cast<std::size_t>(scheduler_.worker_index())]; }

  void resize(ImageSize size) {
    if (size.width < 1 || size.height < 1 || size.width > largest_side || size.height > largest_side)
      throw InputError("the soft backend draws pictures of 1 to " + std::to_string(largest_side) + " pixels a side");
    const std::size_t pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    image_.size = size;
    image_.rgba.resize(4 * pixels);
    image_.depth.resize(pixels);
  }

  // The visible cells, their places in the vertex array, and the batches: consecutive cells of about equal work.
  void gather(const Selection& selection, FrameStats& stats) {
    cells_.clear();
    batch_begin_.assign(1, 0);
    std::size_t vertices = 0, in_batch = 0;
    for (const SelectedCell& selected : selection.cells) {
      if (!selected.visible) continue;
      const Cell& cell = hierarchy_->cells[selected.cell];
      cells_.push_back({selected, static_cast<std::uint32_t>(vertices)});
      vertices += cell.positions.size();
      in_batch += cell.triangles.size();
      stats.triangles += cell.triangles.size();
      if (in_batch >= triangles_per_batch) {
        batch_begin_.push_back(cells_.size());
        in_batch = 0;
      }
    }
    if (batch_begin_.back() != cells_.size()) batch_begin_.push_back(cells_.size());
    if (vertices >= clipped_bit)
      throw ResourceError("the selected cells have more than 2^31 vertices; raise the pixel error");
    stats.cells = cells_.size();
    vertices_.resize(std::max(vertices_.size(), vertices));
    batches_.resize(batch_begin_.size() - 1);
  }

  void transform(const Frame& frame, const Viewport& viewport) {
    scheduler_.for_chunks(cells_.size(), 1, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k) {
        const std::size_t count = hierarchy_->cells[cells_[k].selected.cell].positions.size();
        transform_cell(frame, viewport, cells_[k].selected, workplace().morph,
                       std::span(vertices_).subspan(cells_[k].first_vertex, count));
      }
    });
  }

  void bin(const Frame& frame, const Viewport& viewport, const TileGrid& grid) {
    scheduler_.for_chunks(batches_.size(), 1, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k) {
        const auto cells = std::span(cells_).subspan(batch_begin_[k], batch_begin_[k + 1] - batch_begin_[k]);
        bin_batch(frame, viewport, grid, cells, vertices_, static_cast<std::uint32_t>(k), workplace().bin, batches_[k]);
      }
    });
  }

  void rasterize(const Frame& frame, const TileGrid& grid) {
    scheduler_.for_chunks(grid.count(), 1, [&](ChunkRange range) {
      for (std::size_t tile = range.begin; tile < range.end; ++tile)
        draw_tile(frame, grid, tile, batches_, vertices_, *workplace().tile, image_);
    });
  }

  Scheduler& scheduler_;
  const Hierarchy* hierarchy_ = nullptr;
  std::vector<Workplace> workers_;
  std::vector<DrawnCell> cells_;
  std::vector<std::size_t> batch_begin_;  // ranges in cells_, one per batch and one more
  std::vector<WindowVertex> vertices_;    // of all drawn cells; only ever grows
  std::vector<Batch> batches_;
  Image image_;
};

}  // namespace
}  // namespace soft

std::unique_ptr<Renderer> make_soft_renderer(Scheduler& scheduler) {
  return std::make_unique<soft::SoftRenderer>(scheduler);
}

}  // namespace lodestone
