#include "core/hierarchy/construct/finest_cell.h"

#include <algorithm>
#include <array>

#include "core/base/prefetch.h"
#include "core/hierarchy/model/pack_normals.h"

namespace lodestone {
namespace {

// FinestCellScratch::place of a vertex that no triangle has used yet: of this cell alone, or plus 1 of several cells.
constexpr std::uint32_t new_own = 0xffff'fffeu;

// Looks the vertices up, in the order of cell.ids. Returns the number of those of this cell alone.
std::size_t gather_vertices(const FinestVertices& all, CellBuild& cell, FinestCellScratch& s) {
  const std::size_t count = cell.ids.size();
  s.place.resize(count);
  s.gathered.resize(count);
  std::size_t shared = 0;
  Float4 lo = to_float4(cell.bounds.lo), hi = to_float4(cell.bounds.hi);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t ahead = cell.ids[std::min(i + prefetch_distance, count - 1)];
    prefetch(&all.sharing[ahead]);
    prefetch(&all.positions[ahead]);
    const std::uint32_t is_shared = all.sharing[cell.ids[i]] >> 31;
    s.place[i] = new_own + is_shared;
    shared += is_shared;
    s.gathered[i] = to_float4(all.positions[cell.ids[i]]);
    lo = min(s.gathered[i], lo);
    hi = max(s.gathered[i], hi);
  }
  cell.bounds = {to_vec3f(lo), to_vec3f(hi)};
  return count - shared;
}

// One pass over the sorted triangles: numbers vertices by first use, those of this cell alone first, sums normals and
// measures edges.
EdgeLengths visit_triangles(float limit, std::size_t first_shared, CellBuild& cell, FinestCellScratch& s) {
  s.normals.assign(s.gathered.size(), Float4{});
  std::uint32_t* const place = s.place.data();
  const Float4* const positions = s.gathered.data();
  Float4* const normals = s.normals.data();
  std::array<std::uint32_t, 2> next{0, static_cast<std::uint32_t>(first_shared)};
  EdgeLengths lengths(limit);
  const auto place_of = [&](std::uint32_t v) {
    if (place[v] >= new_own) place[v] = next[place[v] - new_own]++;
    return place[v];
  };
  for (std::size_t i = 0; i < s.triangles.size(); ++i) {
    const auto& v = s.triangles[i].v;
    const std::uint32_t a = place_of(v[0]), b = place_of(v[1]), c = place_of(v[2]);
    cell.triangles[i] = {{a, b, c}};
    const Float4 ab = positions[v[1]] - positions[v[0]], ac = positions[v[2]] - positions[v[0]];
    const Float4 normal = cross_zxy(ab, ac);
    normals[a] += normal;
    normals[b] += normal;
    normals[c] += normal;
    lengths.add(ab, positions[v[2]] - positions[v[1]], ac);
  }
  for (Float4& n : s.normals) n = yzx(n);
  return lengths;
}

void place_vertices(const FinestVertices& all, std::size_t first_shared, CellBuild& cell, FinestCellScratch& s) {
  const std::size_t count = cell.ids.size();
  cell.slab.allocate(count, count - first_shared, 0, all.attributes);
  s.ids.assign(cell.ids.begin(), cell.ids.end());
  for (std::size_t i = 0; i < count; ++i) {
    cell.slab.positions[s.place[i]] = to_vec3f(s.gathered[i]);
    cell.ids[s.place[i]] = s.ids[i];
  }
  std::copy(cell.ids.begin() + static_cast<std::ptrdiff_t>(first_shared), cell.ids.end(), cell.slab.shared_ids.begin());
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

std::span<const Float4> make_finest_cell(const FinestVertices& all, CellCode code, int level, float sigma0,
                                         CellBuild& cell, FinestCellScratch& s) {
  const std::size_t first_shared = gather_vertices(all, cell, s);
  s.triangles.resize(cell.triangles.size());
  sort_compactly(cell.triangles, s.gathered, code, level, s.triangles, s.boxes);
  const EdgeLengths lengths = visit_triangles(sigma0 * cell_size(level), first_shared, cell, s);
  place_vertices(all, first_shared, cell, s);
  if (all.attributes.wedges) join_normals(all, first_shared, cell, s);
  pack_normals(std::span(s.normals).first(first_shared), cell.slab.normals);
  set_edge_statistics(cell, level, lengths);
  set_box_statistics(cell, level);
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
