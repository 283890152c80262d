// Stages 1 and 2 for all cells of a pass: vertices to the window, triangles into the lists of tiles. The picture is one
// pass, a shadow map, seen from the light, another.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/backends/soft/kernels.h"
#include "render/backends/soft/setup_stage.h"

namespace lodestone::soft {

// The triangles of a model that a pass draws, where its materials tell them apart (render/effects/transparency.h).
enum class MaterialShare : std::uint8_t { all, opaque, layers };

// The triangles of a pass by the side that they show.
enum class ShownSide : std::uint8_t { either, front, back };

// Triangles of a cell that are processed together.
struct PartToDraw {
  std::uint32_t cell = 0;                 // its number in drawn()
  std::span<const TriangleRange> ranges;  // as SelectedCell has them
};

struct PassModel {
  const ModelFrame* model = nullptr;
  MaterialShare share = MaterialShare::all;
};

// The models to be drawn, their selections and the projection.
struct GeometryPass {
  std::vector<PassModel> models;
  const SurfaceTextures* materials = nullptr;  // null: of no interest, all triangles are drawn from both sides
  bool both_sides = false;                     // single-sided materials, too
  ShownSide side = ShownSide::either;
  ViewProjection ModelFrame::*projection = &ModelFrame::view_projection;
  const Selection* ModelFrame::*selection = &ModelFrame::selection;  // its visible cells
  ImageSize size;
};

// The opaque surfaces of the frame, and those that are drawn as layers.
[[nodiscard]] GeometryPass opaque_pass(const Frame& frame, const SurfaceTextures& materials);
[[nodiscard]] GeometryPass layers_pass(const Frame& frame, const SurfaceTextures& materials);

class GeometryStage {
 public:
  // One for each worker.
  struct Workplace {
    std::vector<WindowVertex> vertices;  // of the cell at hand
    std::vector<DetailLimit> limits;     // near it
    std::vector<float> adaptive;         // its lambdas by adaptive radii
    std::vector<Triangle> sifted;        // its triangles, where only some are drawn
    std::unique_ptr<SetupLists> lists = std::make_unique_for_overwrite<SetupLists>();
    TileBins bins;
  };

  GeometryStage(Scheduler& scheduler, const Kernels& kernels)
      : scheduler_(scheduler), kernels_(kernels), workers_(static_cast<std::size_t>(scheduler.workers())) {}

  // Results are valid until the next run; memory is kept for it.
  void run(const GeometryPass& pass, int samples) {
    gather(pass);
    process(pass, samples, all_);
  }
  // The two halves of a run: the cells of the pass, and parts of them, processed. The second may be repeated with other
  // triangles.
  void gather(const GeometryPass& pass);
  void process(const GeometryPass& pass, int samples, std::span<const PartToDraw> parts);

  [[nodiscard]] DrawnCells drawn() const { return {cells_, cell_of_block_}; }
  [[nodiscard]] std::span<const PartToDraw> all() const { return all_; }
  [[nodiscard]] std::span<const Workplace> workers() const { return workers_; }
  // Cells and triangles of models that are drawn in two shares count once.
  [[nodiscard]] std::uint64_t cells() const { return counted_cells_; }
  [[nodiscard]] std::uint64_t triangles() const { return triangles_; }
  [[nodiscard]] std::uint64_t morphing_vertices() const { return morphing_vertices_; }

 private:
  void add(const PassModel& model, const SelectedCell& selected);
  [[nodiscard]] std::span<const Triangle> triangles_of(const GeometryPass& pass, std::uint32_t number,
                                                       TriangleRange range, Workplace& w) const;
  void place_lambdas();
  template <int Samples>
  void process_parts(const GeometryPass& pass, std::span<const PartToDraw> parts);
  [[nodiscard]] VertexJob vertex_job(const SetupContext& context, const DrawnCell& drawn, Workplace& w) const;

  Scheduler& scheduler_;
  const Kernels& kernels_;
  std::vector<Workplace> workers_;
  std::vector<DrawnCell> cells_;
  std::vector<MaterialShare> shares_;         // of cells_
  std::vector<std::uint32_t> cell_of_block_;  // DrawnCells
  std::vector<PartToDraw> all_;               // of cells_: what the selection shows of each
  std::unique_ptr<float[]> lambdas_;          // of all cells that morph; only ever grows
  std::size_t lambda_room_ = 0;
  std::uint64_t counted_cells_ = 0, triangles_ = 0, morphing_vertices_ = 0;
};

// Stage 3 for tile number `number`: what of it is seen.
template <int Samples>
void draw_tile(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers, std::size_t number,
               PixelRect rect, TileBuffer<Samples>& tile) {
  tile.clear();
  for (const GeometryStage::Workplace& w : workers)
    w.bins.fragments.for_each_run(
        number, [&](const Fragment* first, const Fragment* last) { tile.draw_fragments(first, last); });
  for (const GeometryStage::Workplace& w : workers)
    w.bins.triangles.for_each_run(number, [&](const TriangleRecord* first, const TriangleRecord* last) {
      kernels.of<Samples>().draw_triangles(first, last, rect, tile);
    });
}

// The same for counts: adds to those of the tile's samples, in the order of TileBuffer, how many triangles cover each.
template <int Samples>
void count_tile(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers, std::size_t number,
                PixelRect rect, std::int32_t* counts) {
  for (const GeometryStage::Workplace& w : workers) {
    w.bins.fragments.for_each_run(number, [&](const Fragment* first, const Fragment* last) {
      for (const Fragment* f = first; f != last; ++f) ++counts[f->sample];
    });
    w.bins.triangles.for_each_run(number, [&](const TriangleRecord* first, const TriangleRecord* last) {
      kernels.of<Samples>().count_triangles(first, last, rect, counts);
    });
  }
}

}  // namespace lodestone::soft
