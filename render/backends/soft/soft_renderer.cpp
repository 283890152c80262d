// Sort-middle rendering (molnar1994) into a visibility buffer (burns2013): vertices and triangles by
// cell, pixels by tile. Workers share nothing that they write, except for the picture, of which each tile has its own
// part. What reaches a pixel is a minimum over all triangles, so the picture depends neither on the number of threads
// nor on their timing.
#include "render/backends/soft/soft_renderer.h"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "core/base/error.h"
#include "render/backends/soft/setup_stage.h"

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
      : scheduler_(scheduler), kernels_(kernels), workers_(static_cast<std::size_t>(scheduler.workers())) {}

  [[nodiscard]] std::string_view name() const override { return "soft"; }
  void upload(const Hierarchy& hierarchy) override { hierarchy_ = &hierarchy; }
  [[nodiscard]] Image read_back() override { return image_; }

  FrameStats draw(const Frame& frame) override {
    assert(hierarchy_ && frame.selection && frame.morph.hierarchy == hierarchy_);
    check_frame(frame, largest_side);
    Stopwatch stage, total;
    FrameStats stats;
    resize(frame.size);
    gather(frame, stats);
    const Viewport viewport(frame.size);
    const TileGrid grid(frame.size);
    if (frame.samples == 1) {
      draw_samples<1>({&frame, &viewport, &grid}, stage, stats);
    } else {
      draw_samples<4>({&frame, &viewport, &grid}, stage, stats);
    }
    stats.milliseconds["total"] = total.lap();
    return stats;
  }

 private:
  // One per worker; reused between frames.
  struct Workplace {
    std::vector<WindowVertex> vertices;  // of the cell at hand
    std::vector<DetailLimit> limits;     // near it
    std::unique_ptr<SetupLists> lists = std::make_unique_for_overwrite<SetupLists>();
    TileBins bins;
    std::unique_ptr<TileBuffer<1>> single = std::make_unique<TileBuffer<1>>();
    std::unique_ptr<TileBuffer<4>> multi;  // made when first used

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

  Workplace& workplace() { return workers_[static_cast<std::size_t>(scheduler_.worker_index())]; }

  template <int Samples>
  void draw_samples(const SetupContext& context, Stopwatch& stage, FrameStats& stats) {
    process_cells<Samples>(context);
    stats.milliseconds["geometry"] = stage.lap();
    draw_tiles<Samples>(context);
    stats.milliseconds["raster"] = stage.lap();
  }

  void resize(ImageSize size) {
    const std::size_t pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    image_.size = size;
    image_.rgba.resize(4 * pixels);
    image_.depth.resize(pixels);
  }

  // The visible cells, the numbers of their triangles and the places of their lambdas.
  void gather(const Frame& frame, FrameStats& stats) {
    cells_.clear();
    cell_of_block_.clear();
    std::size_t morphing_vertices = 0;
    for (const SelectedCell& selected : frame.selection->cells) {
      if (!selected.visible) continue;
      const Cell& cell = hierarchy_->cells[selected.cell];
      add(selected, cell);
      if (cells_.back().morphing) morphing_vertices += cell.positions.size();
      stats.triangles += cell.triangles.size();
    }
    stats.cells = cells_.size();
    constexpr std::size_t numbers = std::size_t{1} << (32 - numbers_per_block_bits);
    if (cell_of_block_.size() > numbers)
      throw ResourceError("the selected cells have more than 2^32 triangles; raise the pixel error");
    place_lambdas(morphing_vertices);
  }

  void place_lambdas(std::size_t vertices) {
    if (vertices > lambda_room_) {
      lambdas_ = std::make_unique_for_overwrite<float[]>(vertices);
      lambda_room_ = vertices;
    }
    float* next = lambdas_.get();
    for (DrawnCell& drawn : cells_) {
      if (!drawn.morphing) continue;
      drawn.lambdas = next;
      next += hierarchy_->cells[drawn.cell].positions.size();
    }
  }

  void add(const SelectedCell& selected, const Cell& cell) {
    DrawnCell drawn;
    drawn.cell = selected.cell;
    drawn.level = selected.level;
    drawn.morphing = selected.morphing && cell.parent != no_cell;
    drawn.first_triangle = static_cast<TriangleNumber>(cell_of_block_.size() << numbers_per_block_bits);
    drawn.normals = cell.normals.data();
    if (drawn.morphing) {
      drawn.coarser_normals = hierarchy_->cells[cell.parent].normals.data();
      drawn.parents = cell.parents.data();
    }
    constexpr std::size_t block = std::size_t{1} << numbers_per_block_bits;
    cell_of_block_.resize(cell_of_block_.size() + (cell.triangles.size() + block - 1) / block,
                          static_cast<std::uint32_t>(cells_.size()));
    cells_.push_back(drawn);
  }

  // Stages 1 and 2 of a cell one after the other: its vertices are still in the cache.
  template <int Samples>
  void process_cells(const SetupContext& context) {
    for (Workplace& w : workers_) {
      w.bins.fragments.reset(context.grid->count());
      w.bins.triangles.reset(context.grid->count());
    }
    scheduler_.for_chunks(cells_.size(), 1, [&](ChunkRange range) {
      Workplace& w = workplace();
      for (std::size_t k = range.begin; k < range.end; ++k) {
        const Cell& cell = hierarchy_->cells[cells_[k].cell];
        if (w.vertices.size() < cell.positions.size()) w.vertices.resize(cell.positions.size());
        const VertexJob job = vertex_job(context, cells_[k], cell, w);
        kernels_.transform(job);
        setup_cell(context, kernels_.of<Samples>(), cells_[k], cell.triangles, w.vertices.data(), *w.lists, w.bins);
      }
    });
  }

  [[nodiscard]] VertexJob vertex_job(const SetupContext& context, const DrawnCell& drawn, const Cell& cell,
                                     Workplace& w) const {
    const MorphContext& morph = context.frame->morph;
    VertexJob job;
    job.positions = cell.positions;
    if (drawn.morphing) {
      job.coarser = hierarchy_->cells[cell.parent].positions.data();
      job.parents = cell.parents.data();
      w.limits.clear();
      limits_near(morph.radii->metric, morph.viewpoint, cell.bounds, morph.limits, w.limits);
      job.limits = w.limits;
    }
    job.viewpoint = morph.viewpoint;
    job.metric = morph.radii->metric;
    job.blend = morph.blend;
    job.band_begin = morph.radii->band_begin[drawn.level];
    job.band_end = morph.radii->band_end[drawn.level];
    job.view_projection = &context.frame->view_projection;
    job.viewport = context.viewport;
    job.out = w.vertices.data();
    job.lambdas = drawn.lambdas;
    return job;
  }

  template <int Samples>
  void draw_tiles(const SetupContext& context) {
    const DrawnCells drawn{cells_, cell_of_block_};
    const SampleKernels<Samples>& kernels = kernels_.of<Samples>();
    scheduler_.for_chunks(context.grid->count(), 1, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k) {
        TileBuffer<Samples>& tile = workplace().tile<Samples>();
        const PixelRect rect = context.grid->rect(k);
        tile.clear();
        for (const Workplace& w : workers_)
          w.bins.fragments.for_each_run(
              k, [&](const Fragment* first, const Fragment* last) { tile.draw_fragments(first, last); });
        for (const Workplace& w : workers_)
          w.bins.triangles.for_each_run(k, [&](const TriangleRecord* first, const TriangleRecord* last) {
            kernels.draw_triangles(first, last, rect, tile);
          });
        kernels.resolve({context.frame, context.viewport, &drawn, rect, &image_}, tile);
      }
    });
  }

  Scheduler& scheduler_;
  const Kernels& kernels_;
  const Hierarchy* hierarchy_ = nullptr;
  std::vector<Workplace> workers_;
  std::vector<DrawnCell> cells_;
  std::vector<std::uint32_t> cell_of_block_;  // DrawnCells
  std::unique_ptr<float[]> lambdas_;          // of all cells that morph; only ever grows
  std::size_t lambda_room_ = 0;
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
