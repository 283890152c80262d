#include "core/hierarchy/construct/finest_cell.h"

#include <algorithm>

#include "core/base/prefetch.h"
#include "core/hierarchy/model/pack_normals.h"

namespace lodestone {
namespace {

// Stable partition of the vertices: those of this cell alone first, shared ones last. Returns the number of the former.
std::size_t move_shared_last(const FinestVertices& all, CellBuild& cell, FinestCellScratch& s) {
  const std::size_t count = cell.ids.size();
  s.renumbered.resize(count);
  s.ids.resize(count);
  s.shared.resize(count);
  std::uint32_t own = 0, shared = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t ahead = cell.ids[std::min(i + prefetch_distance, count - 1)];
    prefetch(&all.sharing[ahead]);
    prefetch(&all.positions[ahead]);
    const std::uint32_t is_shared = all.sharing[cell.ids[i]] >> 31;
    s.renumbered[i] = own;
    s.ids[own] = cell.ids[i];
    s.shared[shared] = i;
    own += 1 - is_shared;
    shared += is_shared;
  }
  for (std::uint32_t k = 0; k < shared; ++k) {
    s.renumbered[s.shared[k]] = own + k;
    s.ids[own + k] = cell.ids[s.shared[k]];
  }
  std::copy(s.ids.begin(), s.ids.end(), cell.ids.begin());
  return own;
}

void place_vertices(const FinestVertices& all, std::size_t first_shared, CellBuild& cell, FinestCellScratch& s) {
  const std::size_t count = cell.ids.size();
  cell.slab.allocate(count, count - first_shared, 0, all.attributes);
  s.positions.resize(count);
  Float4 lo = to_float4(cell.bounds.lo), hi = to_float4(cell.bounds.hi);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p = all.positions[cell.ids[i]];
    cell.slab.positions[i] = p;
    s.positions[i] = to_float4(p);
    lo = min(s.positions[i], lo);
    hi = max(s.positions[i], hi);
  }
  cell.bounds = {to_vec3f(lo), to_vec3f(hi)};
  std::copy(cell.ids.begin() + static_cast<std::ptrdiff_t>(first_shared), cell.ids.end(), cell.slab.shared_ids.begin());
}

// One pass over the triangles: sets their final ids, sums normals and measures edges.
EdgeLengths visit_triangles(float limit, CellBuild& cell, FinestCellScratch& s) {
  s.normals.assign(s.positions.size(), Float4{});
  const std::uint32_t* const renumbered = s.renumbered.data();
  const Float4* const positions = s.positions.data();
  Float4* const normals = s.normals.data();
  EdgeLengths lengths(limit);
  for (Triangle& t : cell.triangles) {
    const std::uint32_t a = renumbered[t.v[0]], b = renumbered[t.v[1]], c = renumbered[t.v[2]];
    t = {{a, b, c}};
    const Float4 ab = positions[b] - positions[a], ac = positions[c] - positions[a];
    const Float4 normal = cross_zxy(ab, ac);
    normals[a] += normal;
    normals[b] += normal;
    normals[c] += normal;
    lengths.add(ab, positions[c] - positions[b], ac);
  }
  for (Float4& n : s.normals) n = yzx(n);
  return lengths;
}

// The normal of a vertex is the sum over all its wedges.
void join_normals(const FinestVertices& all, std::size_t first_shared, CellBuild& cell, FinestCellScratch& s) {
  cell.vertex_ids.resize(cell.ids.size());
  for (std::size_t i = 0; i < cell.ids.size(); ++i) cell.vertex_ids[i] = all.wedges.vertex[cell.ids[i]];
  s.by_vertex.clear();
  for (std::uint32_t i = 0; i < first_shared; ++i) s.by_vertex.emplace_back(cell.vertex_ids[i], i);
  std::sort(s.by_vertex.begin(), s.by_vertex.end());
  for (auto first = s.by_vertex.begin(); first != s.by_vertex.end();) {
    const auto last = std::find_if(first, s.by_vertex.end(), [&](const auto& w) { return w.first != first->first; });
    Float4 sum{};
    for (auto w = first; w != last; ++w) sum += s.normals[w->second];
    for (auto w = first; w != last; ++w) s.normals[w->second] = sum;
    first = last;
  }
}

}  // namespace

std::span<const Float4> make_finest_cell(const FinestVertices& all, CellCode code, int grid, float sigma0,
                                         CellBuild& cell, FinestCellScratch& s) {
  const std::size_t first_shared = move_shared_last(all, cell, s);
  place_vertices(all, first_shared, cell, s);
  const EdgeLengths lengths = visit_triangles(sigma0 * cell_size(grid), cell, s);
  s.triangles.assign(cell.triangles.begin(), cell.triangles.end());
  sort_compactly(s.triangles, s.positions, code, grid, cell.triangles, s.boxes);
  if (all.attributes.wedges) join_normals(all, first_shared, cell, s);
  pack_normals(std::span(s.normals).first(first_shared), cell.slab.normals);
  set_edge_statistics(cell, grid, lengths);
  set_box_statistics(cell, grid);
  return std::span(s.normals).subspan(first_shared);
}

void give_attributes(const FinestVertices& all, CellBuild& cell) {
  const WedgeAttributes& wedges = all.wedges;
  for (std::size_t i = 0; i < cell.ids.size(); ++i) {
    const std::uint32_t w = cell.ids[i];
    if (all.attributes.uv) cell.slab.uv[i] = wedges.uv[w];
    if (all.attributes.colours) cell.slab.colours[i] = wedges.colour[w];
    if (all.attributes.materials) cell.slab.materials[i] = wedges.material[w];
    if (!wedges.normal.empty() && wedges.normal[w] != Vec3f{}) cell.slab.normals[i] = pack_normal(wedges.normal[w]);
  }
  sort_by_material(cell);
}

}  // namespace lodestone
