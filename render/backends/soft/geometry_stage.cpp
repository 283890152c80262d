#include "render/backends/soft/geometry_stage.h"

#include <algorithm>
#include <cassert>

#include "core/base/error.h"
#include "core/hierarchy/model/material_of.h"
#include "render/backends/soft/clip.h"
#include "render/effects/transparency.h"
#include "render/lod/limits.h"
#include "render/textures/surface_textures.h"

namespace lodestone::soft {
namespace {

// True if the triangle, whose transformed vertices are those of its cell, shows its back: it turns clockwise in the
// picture. Corners that wait to be clipped are taken before the division, where the same is the sign of a determinant.
bool shows_back(const ViewProjection& projection, const DrawnCell& drawn, const Triangle& t,
                const std::vector<WindowVertex>& vertices) {
  const WindowVertex &a = vertices[t.v[0]], &b = vertices[t.v[1]], &c = vertices[t.v[2]];
  if (a.inverse_w != 0 && b.inverse_w != 0 && c.inverse_w != 0)
    return doubled_area({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) > 0;
  const auto [p, q, r] = clip_corners(projection, drawn, t.v);
  const auto minor = [](const ClipVertex& m, const ClipVertex& n) { return double{m.x} * n.y - double{n.x} * m.y; };
  return minor(p, q) * r.w + minor(q, r) * p.w + minor(r, p) * q.w < 0;
}

// Vertices behind the plane wait to be clipped, as those outside the near plane do.
void mark_clipped(const Plane& plane, const DrawnCell& drawn, std::vector<WindowVertex>& vertices) {
  for (std::uint32_t v = 0; v < drawn.own->positions.size(); ++v) {
    if (!(distance_from(plane, drawn_position(drawn, VertexId(v))) < 0)) continue;
    WindowVertex& vertex = vertices[v];
    const std::uint32_t outside = vertex.inverse_w == 0 ? static_cast<std::uint32_t>(vertex.x) : 0;
    vertex = {static_cast<std::int32_t>(outside | Outside::clip), 0, 0, 0};
  }
}

}  // namespace

GeometryPass opaque_pass(const Frame& frame, const SurfaceTextures& materials) {
  GeometryPass pass;
  for (const ModelFrame& model : frame.models)
    if (!effects::is_transparent(frame, model))
      pass.models.push_back({&model, shows_alpha(frame, model) ? MaterialShare::opaque : MaterialShare::all});
  pass.materials = &materials;
  pass.size = frame.size;
  return pass;
}

GeometryPass layers_pass(const Frame& frame, const SurfaceTextures& materials) {
  GeometryPass pass;
  for (const ModelFrame& model : frame.models) {
    if (effects::is_transparent(frame, model)) {
      pass.models.push_back({&model});
    } else if (shows_alpha(frame, model)) {
      pass.models.push_back({&model, MaterialShare::layers});
    }
  }
  pass.materials = &materials;
  pass.size = frame.size;
  return pass;
}

void GeometryStage::process(const GeometryPass& pass, int samples, std::span<const PartToDraw> parts) {
  if (samples == 1) {
    process_parts<1>(pass, parts);
  } else {
    process_parts<4>(pass, parts);
  }
}

// The visible cells, the numbers of their triangles and the places of their lambdas.
void GeometryStage::gather(const GeometryPass& pass) {
  cells_.clear();
  shares_.clear();
  cell_of_block_.clear();
  all_.clear();
  counted_cells_ = triangles_ = morphing_vertices_ = 0;
  for (const PassModel& model : pass.models)
    for (const SelectedCell& selected : (model.model->*pass.selection)->cells)
      if (selected.visible) add(model, selected);
  constexpr std::size_t numbers = std::size_t{1} << (32 - numbers_per_block_bits);
  if (cell_of_block_.size() > numbers)
    throw ResourceError("the selected cells have more than 2^32 triangles; raise the pixel error");
  place_lambdas();
  const std::size_t tiles = TileGrid(pass.size).count();
  for (Workplace& w : workers_) {
    w.bins.fragments.reset(tiles);
    w.bins.triangles.reset(tiles);
  }
}

void GeometryStage::add(const PassModel& passed, const SelectedCell& selected) {
  const ModelFrame& model = *passed.model;
  const Hierarchy& hierarchy = *model.morph.hierarchy;
  const Cell& cell = hierarchy.cells[selected.cell];
  DrawnCell drawn;
  drawn.model = &model;
  drawn.cell = selected.cell;
  drawn.level = selected.level;
  drawn.own = &cell;
  drawn.first_triangle = static_cast<TriangleNumber>(cell_of_block_.size() << numbers_per_block_bits);
  drawn.positions = cell.positions.data();
  drawn.normals = cell.normals.data();
  if (hierarchy.attributes.uv) drawn.uv = cell.attributes.uv.data();
  drawn.morphing = selected.morphing && cell.parent != no_cell && model.effects.contains(Effect::geomorph);
  if (drawn.morphing) {
    drawn.coarser = &hierarchy.cells[cell.parent];
    drawn.coarser_positions = drawn.coarser->positions.data();
    drawn.coarser_normals = drawn.coarser->normals.data();
    if (hierarchy.attributes.uv) drawn.coarser_uv = drawn.coarser->attributes.uv.data();
    drawn.parents = cell.parents;
    morphing_vertices_ += cell.positions.size();
  }
  constexpr std::size_t block = std::size_t{1} << numbers_per_block_bits;
  cell_of_block_.resize(cell_of_block_.size() + (cell.triangles.size() + block - 1) / block,
                        static_cast<std::uint32_t>(cells_.size()));
  all_.push_back({static_cast<std::uint32_t>(cells_.size()), selected.ranges});
  cells_.push_back(drawn);
  shares_.push_back(passed.share);
  if (passed.share == MaterialShare::layers) return;
  ++counted_cells_;
  triangles_ += drawn_triangles(cell, selected.ranges);
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

// A cell's triangles are set up right after its vertices, which are still in the cache. Their numbers increase in the
// order of the cell, no matter which of them are drawn first.
template <int Samples>
void GeometryStage::process_parts(const GeometryPass& pass, std::span<const PartToDraw> parts) {
  const Viewport viewport(pass.size);
  const TileGrid grid(pass.size);
  const SetupContext context{pass.projection, &viewport, &grid};
  scheduler_.name_work("geometry");
  scheduler_.for_chunks(parts.size(), 1, [&](ChunkRange chunk) {
    Workplace& w = workers_[static_cast<std::size_t>(scheduler_.worker_index())];
    for (const PartToDraw& part : parts.subspan(chunk.begin, chunk.end - chunk.begin)) {
      const DrawnCell& drawn = cells_[part.cell];
      const Cell& cell = *drawn.own;
      if (drawn_triangles(cell, part.ranges) == 0) continue;
      if (w.vertices.size() < cell.positions.size()) w.vertices.resize(cell.positions.size());
      const auto& clip = drawn.model->clip;
      const int side = clip ? side_of(*clip, drawn_bounds(*drawn.model->morph.hierarchy, drawn.cell, drawn.level)) : 1;
      if (side < 0) continue;
      const VertexJob job = vertex_job(context, drawn, w);
      kernels_.transform(job);
      if (side == 0) mark_clipped(*clip, drawn, w.vertices);
      for_each_range(cell, part.ranges, [&](TriangleRange range) {
        const CellInWindow window{triangles_of(pass, part.cell, range, w), w.vertices.data(),
                                  drawn.first_triangle + range.begin};
        setup_cell(context, kernels_.of<Samples>(), drawn, window, *w.lists, w.bins);
      });
    }
  });
}

// The cell's own triangles in the range, or those of materials that the pass draws which do not show the back of a
// single-sided one.
std::span<const Triangle> GeometryStage::triangles_of(const GeometryPass& pass, std::uint32_t number,
                                                      TriangleRange range, Workplace& w) const {
  const DrawnCell& drawn = cells_[number];
  const Cell& cell = *drawn.own;
  const MaterialShare share = shares_[number];
  const bool one_side = pass.materials != nullptr && !pass.both_sides && effects::has_one_side(*drawn.model);
  const bool by_material = share != MaterialShare::all || one_side;
  const bool sifts = by_material || pass.side != ShownSide::either;
  if (!sifts && !cell.triangles.is_short()) return cell.triangles.wide().subspan(range.begin, range.end - range.begin);
  const auto is_back = [&](const Triangle& t) {
    return shows_back(drawn.model->*pass.projection, drawn, t, w.vertices);
  };
  const auto has_material = [&](const Triangle& t) {
    const SurfaceMaterial& m = pass.materials->materials(
        drawn.model->model)[material_of(*drawn.model->morph.hierarchy, cell, t.v[0]) + std::uint32_t{1}];
    const bool opaque = m.alpha_mode == AlphaMode::opaque;
    if (share != MaterialShare::all && opaque != (share == MaterialShare::opaque)) return false;
    return !(one_side && m.one_sided && is_back(t));
  };
  w.sifted.clear();
  if (!sifts) {
    w.sifted.assign(cell.triangles.begin() + range.begin, cell.triangles.begin() + range.end);
    return w.sifted;
  }
  for (auto at = cell.triangles.begin() + range.begin; at != cell.triangles.begin() + range.end; ++at) {
    const Triangle t = *at;
    if (by_material && !has_material(t)) continue;
    if (pass.side != ShownSide::either && is_back(t) != (pass.side == ShownSide::back)) continue;
    w.sifted.push_back(t);
  }
  return w.sifted;
}

VertexJob GeometryStage::vertex_job(const SetupContext& context, const DrawnCell& drawn, Workplace& w) const {
  const MorphContext& morph = drawn.model->morph;
  VertexJob job;
  job.positions = drawn.own->positions;
  if (drawn.morphing) {
    job.coarser = drawn.coarser->positions.data();
    job.parents = drawn.parents;
    job.has_lambdas = !morph.radii->by_cell.empty();
    if (job.has_lambdas) {
      adaptive_lambdas(morph, drawn.cell, w.adaptive);
      const std::span<const std::uint8_t> places = signature_places(morph, drawn.cell);
      float* shared = std::fill_n(drawn.lambdas, drawn.own->positions.size() - places.size(), w.adaptive.front());
      for (const std::uint8_t place : places) *shared++ = w.adaptive[place];
    } else {
      w.limits.clear();
      limits_near(morph.radii->metric, morph.viewpoint, drawn.own->bounds, morph.limits, w.limits);
      job.limits = w.limits;
    }
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
