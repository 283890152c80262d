#include "render/backends/soft/geometry_stage.h"

#include <cassert>

#include "core/base/error.h"

namespace lodestone::soft {

void GeometryStage::run(const GeometryPass& pass, int samples) {
  gather(pass);
  if (samples == 1) {
    process_cells<1>(pass);
  } else {
    process_cells<4>(pass);
  }
}

// The visible cells, the numbers of their triangles and the places of their lambdas.
void GeometryStage::gather(const GeometryPass& pass) {
  cells_.clear();
  cell_of_block_.clear();
  triangles_ = morphing_vertices_ = 0;
  for (const ModelFrame* model : pass.models)
    for (const SelectedCell& selected : (model->*pass.selection)->cells)
      if (selected.visible) add(*model, selected);
  constexpr std::size_t numbers = std::size_t{1} << (32 - numbers_per_block_bits);
  if (cell_of_block_.size() > numbers)
    throw ResourceError("the selected cells have more than 2^32 triangles; raise the pixel error");
  place_lambdas();
}

void GeometryStage::add(const ModelFrame& model, const SelectedCell& selected) {
  const Hierarchy& hierarchy = *model.morph.hierarchy;
  const Cell& cell = hierarchy.cells[selected.cell];
  DrawnCell drawn;
  drawn.model = &model;
  drawn.cell = selected.cell;
  drawn.level = selected.level;
  drawn.own = &cell;
  drawn.first_triangle = static_cast<TriangleNumber>(cell_of_block_.size() << numbers_per_block_bits);
  drawn.normals = cell.normals.data();
  drawn.morphing = selected.morphing && cell.parent != no_cell && model.effects.contains(Effect::geomorph);
  if (drawn.morphing) {
    drawn.coarser = &hierarchy.cells[cell.parent];
    drawn.coarser_normals = drawn.coarser->normals.data();
    drawn.parents = cell.parents.data();
    morphing_vertices_ += cell.positions.size();
  }
  constexpr std::size_t block = std::size_t{1} << numbers_per_block_bits;
  cell_of_block_.resize(cell_of_block_.size() + (cell.triangles.size() + block - 1) / block,
                        static_cast<std::uint32_t>(cells_.size()));
  cells_.push_back(drawn);
  triangles_ += cell.triangles.size();
}

void GeometryStage::place_lambdas() {
  if (morphing_vertices_ > lambda_room_) {
    lambdas_ = std::make_unique_for_overwrite<float[]>(morphing_vertices_);
    lambda_room_ = morphing_vertices_;
  }
  float* next = lambdas_.get();
  for (DrawnCell& drawn : cells_) {
    if (!drawn.morphing) continue;
    drawn.lambdas = next;
    next += drawn.own->positions.size();
  }
}

// A cell's triangles right after its vertices: those are still in the cache.
template <int Samples>
void GeometryStage::process_cells(const GeometryPass& pass) {
  const Viewport viewport(pass.size);
  const TileGrid grid(pass.size);
  const SetupContext context{pass.projection, &viewport, &grid};
  for (Workplace& w : workers_) {
    w.bins.fragments.reset(grid.count());
    w.bins.triangles.reset(grid.count());
  }
  scheduler_.for_chunks(cells_.size(), 1, [&](ChunkRange range) {
    Workplace& w = workers_[static_cast<std::size_t>(scheduler_.worker_index())];
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const Cell& cell = *cells_[k].own;
      if (w.vertices.size() < cell.positions.size()) w.vertices.resize(cell.positions.size());
      const VertexJob job = vertex_job(context, cells_[k], w);
      kernels_.transform(job);
      setup_cell(context, kernels_.of<Samples>(), cells_[k], cell.triangles, w.vertices.data(), *w.lists, w.bins);
    }
  });
}

VertexJob GeometryStage::vertex_job(const SetupContext& context, const DrawnCell& drawn, Workplace& w) const {
  const MorphContext& morph = drawn.model->morph;
  VertexJob job;
  job.positions = drawn.own->positions;
  if (drawn.morphing) {
    job.coarser = drawn.coarser->positions.data();
    job.parents = drawn.parents;
    w.limits.clear();
    limits_near(morph.radii->metric, morph.viewpoint, drawn.own->bounds, morph.limits, w.limits);
    job.limits = w.limits;
  }
  job.viewpoint = morph.viewpoint;
  job.metric = morph.radii->metric;
  job.blend = morph.blend;
  job.band_begin = morph.radii->band_begin[drawn.level];
  job.band_end = morph.radii->band_end[drawn.level];
  job.view_projection = &(drawn.model->*context.projection);
  job.viewport = context.viewport;
  job.out = w.vertices.data();
  job.lambdas = drawn.lambdas;
  return job;
}

}  // namespace lodestone::soft
