// Sort-middle rendering (molnar1994) into a visibility buffer (burns2013): vertices and triangles by
// cell, pixels by tile. Workers share nothing that they write, except for the picture, of which each tile has its own
// part. What reaches a pixel is a minimum over all triangles, so the picture depends neither on the number of threads
// nor on their timing.
#include "render/backends/soft/soft_renderer.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <numeric>

#include "core/base/error.h"
#include "render/backends/soft/geometry_stage.h"
#include "render/backends/soft/occlusion_stage.h"
#include "render/textures/surface_textures.h"

namespace lodestone {
namespace soft {
namespace {

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
  SoftRenderer(Scheduler& scheduler, const Kernels& kernels)
      : scheduler_(scheduler),
        kernels_(kernels),
        geometry_(scheduler, kernels),
        workers_(static_cast<std::size_t>(scheduler.workers())) {}

  [[nodiscard]] std::string_view name() const override { return "soft"; }
  using Renderer::upload;
  void upload(std::span<const Hierarchy* const> models) override {
    models_.assign(models.begin(), models.end());
    textures_.set_models(models);
  }
  [[nodiscard]] Image read_back() override { return image_; }

  FrameStats draw(const Frame& frame) override {
    check_frame(frame, largest_side);
    Stopwatch stage, total;
    FrameStats stats;
    resize(frame.size);
    if (const std::size_t decoded = textures_.prepare(frame, scheduler_)) stats.work["decoded textures"] = decoded;
    stats.warnings = textures_.take_warnings();
    geometry_.gather(picture_pass(frame));
    stats.cells = geometry_.drawn().cells.size();
    stats.triangles = geometry_.triangles();
    if (frame.culls_occluded()) {
      draw_in_two_passes(frame, stage, stats);
    } else {
      draw_cells(frame, geometry_.all(), stage, stats);
    }
    stats.milliseconds["total"] = total.lap();
    count_work(stats);
    return stats;
  }

 private:
  // One per worker; reused between frames.
  struct alignas(64) Workplace {
    std::unique_ptr<TileBuffer<1>> single = std::make_unique<TileBuffer<1>>();
    std::unique_ptr<TileBuffer<4>> multi;  // made when first used
    WorkCounts work{};

    template <int Samples>
    TileBuffer<Samples>& tile() {
      if constexpr (Samples == 1)
        return *single;
      else {
        if (!multi) multi = std::make_unique<TileBuffer<4>>();
        return *multi;
      }
    }
  };

  [[nodiscard]] GeometryPass picture_pass(const Frame& frame) const {
    GeometryPass pass;
    for (const ModelFrame& model : frame.models) {
      assert(model.selection && model.model < models_.size() && model.morph.hierarchy == models_[model.model]);
      pass.models.push_back(&model);
    }
    pass.size = frame.size;
    return pass;
  }

  void resize(ImageSize size) {
    const std::size_t pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    image_.size = size;
    image_.rgba.resize(4 * pixels);
    image_.depth.resize(pixels);
  }

  // Cells of the pass at hand, and the picture of all that has been processed of it, or some of its tiles.
  void draw_cells(const Frame& frame, std::span<const std::uint32_t> cells, Stopwatch& stage, FrameStats& stats,
                  bool again = false) {
    const std::size_t tiles = TileGrid(frame.size).count();
    if (again) touched_.mark(geometry_.workers(), tiles);
    geometry_.process(picture_pass(frame), frame.samples, cells);
    stats.milliseconds["geometry"] += stage.lap();
    tiles_.resize(tiles);
    std::iota(tiles_.begin(), tiles_.end(), 0u);
    if (again) tiles_ = touched_.since_mark(geometry_.workers());
    if (frame.samples == 1) {
      draw_tiles<1>(frame);
    } else {
      draw_tiles<4>(frame);
    }
    stats.milliseconds["raster"] += stage.lap();
  }

  // Tiles that get something in the second pass are drawn as a whole once more.
  void draw_in_two_passes(const Frame& frame, Stopwatch& stage, FrameStats& stats) {
    const DrawnCells drawn = geometry_.drawn();
    draw_cells(frame, occlusion_.first(frame, drawn), stage, stats);
    const std::span<const std::uint32_t> second = occlusion_.second(frame, drawn);
    stats.milliseconds["occlusion"] = stage.lap();
    if (!second.empty()) draw_cells(frame, second, stage, stats, true);
    occlusion_.finish(frame, drawn);
    stats.milliseconds["occlusion"] += stage.lap();
    stats.cells -= occlusion_.hidden_cells();
    stats.triangles -= occlusion_.hidden_triangles();
    if (occlusion_.hidden_cells() > 0) stats.work["hidden cells"] = occlusion_.hidden_cells();
  }

  template <int Samples>
  void draw_tiles(const Frame& frame) {
    eyes_.clear();
    for (const ModelFrame& model : frame.models) eyes_.push_back(eye_of(model.view_projection));
    const Viewport viewport(frame.size);
    const TileGrid grid(frame.size);
    const DrawnCells drawn = geometry_.drawn();
    const SampleKernels<Samples>& kernels = kernels_.of<Samples>();
    const bool culls = frame.culls_occluded();
    scheduler_.for_chunks(tiles_.size(), 1, [&](ChunkRange range) {
      Workplace& here = workers_[static_cast<std::size_t>(scheduler_.worker_index())];
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const std::size_t k = tiles_[i];
        TileBuffer<Samples>& tile = here.template tile<Samples>();
        const PixelRect rect = grid.rect(k);
        tile.clear();
        for (const GeometryStage::Workplace& w : geometry_.workers())
          w.bins.fragments.for_each_run(
              k, [&](const Fragment* first, const Fragment* last) { tile.draw_fragments(first, last); });
        for (const GeometryStage::Workplace& w : geometry_.workers())
          w.bins.triangles.for_each_run(k, [&](const TriangleRecord* first, const TriangleRecord* last) {
            kernels.draw_triangles(first, last, rect, tile);
          });
        kernels.resolve({&frame, &viewport, &drawn, eyes_.data(), rect, &image_, &here.work, &textures_}, tile);
        if (culls) occlusion_.take(tile, rect);
      }
    });
  }

  void count_work(FrameStats& stats) {
    WorkCounts sum{};
    for (Workplace& w : workers_) {
      for (std::size_t k = 0; k < effect_count; ++k) sum[k] += w.work[k];
      w.work = {};
    }
    if (geometry_.morphing_vertices() > 0) stats.work["geomorph"] = geometry_.morphing_vertices();
    for (std::size_t k = 0; k < effect_count; ++k)
      if (sum[k] > 0) stats.work[std::string(effect_names[k])] = sum[k];
  }

  Scheduler& scheduler_;
  const Kernels& kernels_;
  std::vector<const Hierarchy*> models_;
  SurfaceTextures textures_;
  GeometryStage geometry_;
  std::vector<Workplace> workers_;
  std::vector<Eye> eyes_;  // of the models of the frame
  OcclusionStage occlusion_;
  TouchedTiles touched_;
  std::vector<std::uint32_t> tiles_;  // to be drawn
  Image image_;
};

}  // namespace
}  // namespace soft

std::unique_ptr<Renderer> make_soft_renderer(Scheduler& scheduler, const SoftConfig& config) {
  const soft::Kernels* kernels = soft::find_kernels(config.instructions);
  if (!kernels)
    throw UnsupportedError(describe("", "the soft backend", "this processor has no AVX2", "use the baseline"));
  return std::make_unique<soft::SoftRenderer>(scheduler, *kernels);
}

}  // namespace lodestone
