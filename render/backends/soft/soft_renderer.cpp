// Sort-middle rendering (molnar1994) into a visibility buffer (burns2013): vertices and triangles by cell, pixels by
// tile. Workers share nothing that they write, except for the picture, of which each tile has its own part. A pixel
// takes a minimum over all triangles, so that the picture depends neither on the number of threads nor on their timing.
#include "render/backends/soft/soft_renderer.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <numeric>
#include <optional>

#include "parallel/scheduler/clock.h"
#include "render/backends/soft/cut_stage.h"
#include "render/backends/soft/geometry_stage.h"
#include "render/backends/soft/layers.h"
#include "render/backends/soft/occlusion_stage.h"
#include "render/backends/soft/overdraw_tile.h"
#include "render/backends/soft/shadow_map.h"
#include "render/effects/ambient_occlusion.h"
#include "render/effects/overdraw.h"
#include "render/effects/shadow.h"
#include "render/effects/transparency.h"
#include "render/textures/surface_textures.h"

namespace lodestone {
namespace soft {
namespace {

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
    for ([[maybe_unused]] const ModelFrame& model : frame.models)
      assert(model.selection && model.model < models_.size() && model.morph.hierarchy == models_[model.model]);
    Stopwatch stage, total;
    FrameStats stats;
    resize(frame.size);
    if (const std::size_t decoded = textures_.prepare(frame, scheduler_)) stats.work["decoded textures"] = decoded;
    stats.warnings = textures_.take_warnings();
    const bool overdraw = effects::counts_overdraw(frame);
    if (!overdraw && effects::has_shadow_pass(frame)) {
      if (!shadow_map_) shadow_map_.emplace(scheduler_, kernels_);
      shadow_map_->draw(frame, textures_);
      stats.work["shadow triangles"] = shadow_map_->triangles();
      stats.milliseconds["shadow"] = stage.lap();
    }
    has_layers_ = false;
    const bool layered = !overdraw && run_layers(frame);
    has_cuts_ = !overdraw && run_cuts(frame);
    geometry_.gather(overdraw ? count_pass(frame) : opaque_pass(frame, textures_));
    stats.cells = geometry_.cells();
    stats.triangles = geometry_.triangles();
    if (layered) {
      stats.cells += layers_->cells();
      stats.triangles += layers_->triangles();
    }
    if (overdraw) {
      geometry_.process(count_pass(frame), 1, geometry_.all());
      stats.milliseconds["geometry"] = stage.lap();
      stats.work["covered samples"] = count_overdraw(frame);
      stats.milliseconds["raster"] = stage.lap();
    } else if (frame.culls_occluded()) {
      draw_in_two_passes(frame, stage, stats);
    } else {
      draw_parts(frame, geometry_.all(), stage, stats);
    }
    if (!overdraw && effects::has_occlusion_pass(frame)) {
      occlude(frame);
      stats.work["occlusion pixels"] = image_.depth.size();
      stats.milliseconds["ambient occlusion"] = stage.lap();
    }
    stats.milliseconds["total"] = total.lap();
    count_work(stats);
    return stats;
  }

 private:
  // One per worker; reused between frames.
  struct alignas(64) Workplace {
    std::unique_ptr<TileBuffer<1>> single = std::make_unique<TileBuffer<1>>();
    std::unique_ptr<TileBuffer<4>> multi;  // these are made when first used
    std::unique_ptr<TileLayers<1>> single_layers;
    std::unique_ptr<TileLayers<4>> multi_layers;
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
    template <int Samples>
    TileLayers<Samples>& layers() {
      const auto made = [](auto& layers) -> auto& {
        if (!layers) layers = std::make_unique<TileLayers<Samples>>();
        return *layers;
      };
      if constexpr (Samples == 1)
        return made(single_layers);
      else
        return made(multi_layers);
    }
  };

  // All triangles, from both sides.
  [[nodiscard]] static GeometryPass count_pass(const Frame& frame) {
    GeometryPass pass;
    for (const ModelFrame& model : frame.models) pass.models.push_back({&model});
    pass.size = frame.size;
    return pass;
  }

  // Draws the surfaces that are not opaque into lists; true if there may be any.
  bool run_layers(const Frame& frame) {
    const GeometryPass pass = layers_pass(frame, textures_);
    has_layers_ = !pass.models.empty();
    if (!has_layers_) return false;
    if (!layers_) layers_.emplace(scheduler_, kernels_);
    layers_->run(pass, frame.samples);
    return true;
  }

  // Finds the cuts of solids; true if there are any.
  bool run_cuts(const Frame& frame) {
    if (std::ranges::none_of(frame.models, [](const ModelFrame& m) { return m.solid != nullptr; })) return false;
    if (!cuts_) cuts_.emplace(scheduler_, kernels_);
    return cuts_->find(frame);
  }

  void resize(ImageSize size) {
    const std::size_t pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    image_.size = size;
    image_.rgba.resize(4 * pixels);
    image_.depth.resize(pixels);
  }

  static void copy_depth(const TileBuffer<1>& tile, PixelRect rect, Image& to) {
    for (int y = rect.y0; y < rect.y1; ++y)
      std::copy_n(&tile.depth[static_cast<std::size_t>(y - rect.y0) * tile_size], rect.x1 - rect.x0,
                  &to.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(to.size.width) +
                            static_cast<std::size_t>(rect.x0)]);
  }

  // Parts of the pass at hand, and the picture of all that has been processed of it, or some of its tiles.
  void draw_parts(const Frame& frame, std::span<const PartToDraw> parts, Stopwatch& stage, FrameStats& stats,
                  bool again = false) {
    const std::size_t tiles = TileGrid(frame.size).count();
    if (again) touched_.mark(geometry_.workers(), tiles);
    geometry_.process(opaque_pass(frame, textures_), frame.samples, parts);
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
    draw_parts(frame, occlusion_.first(frame, geometry_.drawn(), geometry_.all()), stage, stats);
    const std::span<const PartToDraw> second = occlusion_.second();
    stats.milliseconds["occlusion"] = stage.lap();
    if (!second.empty()) draw_parts(frame, second, stage, stats, true);
    occlusion_.finish();
    stats.milliseconds["occlusion"] += stage.lap();
    stats.cells -= occlusion_.hidden_cells();
    stats.triangles -= occlusion_.hidden_triangles();
    if (occlusion_.hidden_cells() > 0) stats.work["hidden cells"] = occlusion_.hidden_cells();
  }

  template <int Samples>
  void draw_tiles(const Frame& frame) {
    const ShadowView shadow = shadow_map_ ? shadow_map_->view() : ShadowView{};
    eyes_.clear();
    for (const ModelFrame& model : frame.models) eyes_.push_back(eye_of(model.view_projection));
    const Viewport viewport(frame.size);
    const TileGrid grid(frame.size);
    const DrawnCells drawn = geometry_.drawn(), transparent = has_layers_ ? layers_->drawn() : DrawnCells{};
    const SampleKernels<Samples>& kernels = kernels_.of<Samples>();
    const bool culls = frame.culls_occluded();
    scheduler_.name_work("tiles");
    scheduler_.for_chunks(tiles_.size(), 1, [&](ChunkRange range) {
      Workplace& here = workers_[static_cast<std::size_t>(scheduler_.worker_index())];
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const std::size_t k = tiles_[i];
        TileBuffer<Samples>& tile = here.template tile<Samples>();
        const PixelRect rect = grid.rect(k);
        draw_tile<Samples>(kernels_, geometry_.workers(), k, rect, tile);
        ResolveJob job{{&frame, viewport.half_width(), viewport.half_height(), eyes_.data(), &textures_, shadow},
                       &viewport,
                       &drawn,
                       rect,
                       &image_,
                       &here.work,
                       nullptr,
                       effects::has_occlusion_pass(frame)};
        const bool cut = has_cuts_ && cuts_->put_depth(k, tile);
        LayerLight* light = nullptr;
        if (has_layers_) {
          ResolveJob of_layers = job;
          of_layers.drawn = &transparent;
          light = here.template layers<Samples>().draw(kernels_, layers_->workers(), k, tile, of_layers);
        }
        if (cut) {
          if (!light) light = here.template layers<Samples>().none(tile);
          cuts_->put_light(k, tile, *light);
        }
        job.layers = light;
        (job.layers ? kernels.resolve_layered : kernels.resolve)(job, tile);
        if (culls) occlusion_.take(tile, rect);
      }
    });
  }

  void occlude(const Frame& frame) {
    const effects::OcclusionJob job = effects::occlusion_job(frame);
    scheduler_.name_work("ambient occlusion");
    scheduler_.for_chunks(static_cast<std::size_t>(frame.size.height), 16, [&](ChunkRange range) {
      kernels_.occlude(job, static_cast<int>(range.begin), static_cast<int>(range.end), image_);
    });
  }

  // Draws the counts instead of the picture; returns the number of samples that the triangles cover, each triangle
  // counted by itself.
  std::uint64_t count_overdraw(const Frame& frame) {
    const TileGrid grid(frame.size);
    std::atomic<std::uint64_t> sum = 0;
    scheduler_.for_chunks(grid.count(), 1, [&](ChunkRange range) {
      TileBuffer<1>& tile = *workers_[static_cast<std::size_t>(scheduler_.worker_index())].single;
      for (std::size_t k = range.begin; k < range.end; ++k) {
        const PixelRect rect = grid.rect(k);
        draw_tile<1>(kernels_, geometry_.workers(), k, rect, tile);
        copy_depth(tile, rect, image_);
        sum += draw_overdraw(kernels_, geometry_.workers(), k, rect, frame.settings.background, image_);
      }
    });
    return sum;
  }

  void count_work(FrameStats& stats) {
    WorkCounts sum{};
    for (Workplace& w : workers_) {
      for (std::size_t k = 0; k < effect_count; ++k) sum[k] += w.work[k];
      w.work = {};
    }
    const std::uint64_t morphing =
        geometry_.morphing_vertices() + (has_layers_ ? layers_->morphing_vertices() : std::uint64_t{0});
    if (morphing > 0) stats.work["geomorph"] = morphing;
    for (std::size_t k = 0; k < effect_count; ++k)
      if (sum[k] > 0) stats.work[std::string(effect_names[k])] = sum[k];
  }

  Scheduler& scheduler_;
  const Kernels& kernels_;
  std::vector<const Hierarchy*> models_;
  SurfaceTextures textures_;
  GeometryStage geometry_;
  std::vector<Workplace> workers_;
  std::optional<ShadowMap> shadow_map_;  // these are made when first used
  std::optional<GeometryStage> layers_;  // of the transparent models
  std::optional<CutStage> cuts_;
  bool has_layers_ = false, has_cuts_ = false;  // this frame
  std::vector<Eye> eyes_;                       // of the models of the frame
  OcclusionStage occlusion_;
  TouchedTiles touched_;
  std::vector<std::uint32_t> tiles_;  // to be drawn
  Image image_;
};

}  // namespace
}  // namespace soft

std::unique_ptr<Renderer> make_soft_renderer(Scheduler& scheduler, const SoftConfig& config) {
  return std::make_unique<soft::SoftRenderer>(scheduler, soft::find_kernels(config.instructions));
}

}  // namespace lodestone
