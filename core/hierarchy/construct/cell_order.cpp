#include "core/hierarchy/construct/cell_order.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>

namespace lodestone {
namespace {

constexpr std::uint32_t unused = 0xffff'ffffu;
// In vertices: half the size of the index codec's cache. 16 gives files larger by a hundredth, 32 by a thirtieth.
constexpr unsigned cache_size = 8;

void order_run(std::span<Triangle> triangles, std::size_t vertices, CellOrderScratch& s) {
  s.triangles.assign(triangles.begin(), triangles.end());
  meshopt_optimizeVertexCacheFifo(triangles.data()->v.data(), s.triangles.data()->v.data(), 3 * triangles.size(),
                                  vertices, cache_size);
}

// Keeps the triangles of a material together.
void order_triangles(CellBuild& cell, CellOrderScratch& s) {
  const std::span<const std::uint32_t> materials = cell.slab.materials;
  const auto material = [&](const Triangle& t) { return materials.empty() ? 0 : materials[t.v[0]]; };
  for (std::size_t first = 0, end = 0; first < cell.triangles.size(); first = end) {
    while (end < cell.triangles.size() && material(cell.triangles[end]) == material(cell.triangles[first])) ++end;
    order_run(cell.triangles.subspan(first, end - first), cell.vertex_count(), s);
  }
}

// Numbers vertices by first use, own ones first; unused ones follow in their old order.
std::vector<std::uint32_t> number_by_use(std::span<const Triangle> triangles, std::uint32_t first_shared,
                                         std::uint32_t count) {
  std::vector<std::uint32_t> moved(count, unused);
  std::uint32_t next_own = 0, next_shared = first_shared;
  const auto number = [&](std::uint32_t v) {
    if (moved[v] == unused) moved[v] = v < first_shared ? next_own++ : next_shared++;
  };
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) number(v);
  for (std::uint32_t v = 0; v < count; ++v) number(v);
  return moved;
}

// items[first + i] goes to items[moved[first + i]].
template <class T>
void move_items(std::span<T> items, std::uint32_t first, std::span<const std::uint32_t> moved, CellOrderScratch& s) {
  if (items.empty()) return;
  s.values.resize(items.size_bytes());
  std::memcpy(s.values.data(), items.data(), items.size_bytes());
  for (std::size_t i = 0; i < items.size(); ++i)
    std::memcpy(&items[moved[first + i] - first], s.values.data() + i * sizeof(T), sizeof(T));
}

}  // namespace

std::vector<std::uint32_t> order_cell(CellBuild& cell, CellOrderScratch& scratch) {
  const auto count = static_cast<std::uint32_t>(cell.vertex_count());
  const auto first_shared = static_cast<std::uint32_t>(cell.first_shared());
  cell.release_transient();  // in the old order, and not needed any more
  order_triangles(cell, scratch);
  std::vector<std::uint32_t> moved = number_by_use(cell.triangles, first_shared, count);
  for (Triangle& t : cell.triangles)
    for (std::uint32_t& v : t.v) v = moved[v];
  move_items(cell.slab.positions, 0, moved, scratch);
  move_items(cell.slab.normals, 0, moved, scratch);
  move_items(cell.slab.uv, 0, moved, scratch);
  move_items(cell.slab.colours, 0, moved, scratch);
  move_items(cell.slab.materials, 0, moved, scratch);
  move_items(cell.slab.shared_ids, first_shared, moved, scratch);
  move_items(std::span(cell.border_errors), first_shared, moved, scratch);
  return moved;
}

void order_parents(CellBuild& cell, std::span<const std::uint32_t> moved, std::span<const std::uint32_t> parent_moved,
                   CellOrderScratch& scratch) {
  for (std::uint32_t& parent : cell.slab.parents) parent = parent_moved[parent];
  move_items(cell.slab.parents, 0, moved, scratch);
}

}  // namespace lodestone
