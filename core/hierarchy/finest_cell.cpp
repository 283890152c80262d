#include "core/hierarchy/finest_cell.h"

#include <bit>

namespace lodestone {
namespace {

constexpr std::uint32_t empty_slot = 0xffff'ffffu;

// Numbers the input vertices of the triangles in order of appearance, writing the numbers over the ids. A small hash
// table stays in the first-level cache, where a stamp array over all input vertices would not.
void number_vertices(std::span<Triangle> triangles, FinestCellScratch& s) {
  const std::size_t slots = std::bit_ceil(triangles.size() * 3 + 16);  // at most a third full on closed surfaces
  const std::uint32_t mask = static_cast<std::uint32_t>(slots - 1);
  const int shift = 32 - std::countr_zero(slots);
  s.table_keys.assign(slots, empty_slot);
  s.table_values.resize(slots);
  s.vertices.clear();
  for (Triangle& t : triangles) {
    for (std::uint32_t& v : t.v) {
      std::uint32_t slot = (v * 0x9e37'79b9u) >> shift;  // Fibonacci hashing
      while (s.table_keys[slot] != v && s.table_keys[slot] != empty_slot) slot = (slot + 1) & mask;
      if (s.table_keys[slot] == empty_slot) {
        s.table_keys[slot] = v;
        s.table_values[slot] = static_cast<std::uint32_t>(s.vertices.size());
        s.vertices.push_back(v);
      }
      v = s.table_values[slot];
    }
  }
}

// Stable partition: vertices of this cell alone first, shared ones last. Returns the number of shared ones.
std::size_t move_shared_last(const FinestVertices& all, FinestCellScratch& s) {
  std::size_t shared = 0;
  for (const std::uint32_t v : s.vertices) shared += all.sharing[v] >> 31;
  std::uint32_t next_own = 0, next_shared = static_cast<std::uint32_t>(s.vertices.size() - shared);
  s.renumbered.resize(s.vertices.size());
  for (std::size_t i = 0; i < s.vertices.size(); ++i)
    s.renumbered[i] = all.sharing[s.vertices[i]] & FinestVertices::shared_flag ? next_shared++ : next_own++;
  return shared;
}

}  // namespace

void make_finest_cell(const FinestVertices& all, std::span<Triangle> triangles, CellBuild& cell, FinestCellScratch& s) {
  number_vertices(triangles, s);
  const std::size_t shared = move_shared_last(all, s);
  const std::size_t count = s.vertices.size(), first_shared = count - shared;
  cell.triangles = triangles;
  cell.slab.allocate(count, shared, 0);
  cell.ids.resize(count);
  cell.usage.resize(shared);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v = s.vertices[i], to = s.renumbered[i];
    cell.ids[to] = v;
    cell.slab.positions[to] = all.positions[v];
    cell.bounds.extend(all.positions[v]);
  }
  s.normals.assign(count, Vec3f{});
  for (std::size_t k = 0; k < shared; ++k) {
    const std::uint32_t v = cell.ids[first_shared + k];
    cell.slab.shared_ids[k] = v;
    cell.usage[k] = all.shared_usage[all.sharing[v] & ~FinestVertices::shared_flag];
  }
  for (Triangle& t : triangles) {
    for (std::uint32_t& v : t.v) v = s.renumbered[v];
    const Vec3f a = cell.slab.positions[t.v[0]];
    const Vec3f n = cross(cell.slab.positions[t.v[1]] - a, cell.slab.positions[t.v[2]] - a);
    for (const std::uint32_t v : t.v) s.normals[v] = s.normals[v] + n;
  }
  for (std::size_t i = 0; i < count; ++i) {
    // The sum over this cell is the whole sum for a vertex of this cell alone; for the others the partition has it.
    const bool own = i < first_shared;
    cell.slab.normals[i] =
        pack_normal(own ? s.normals[i] : all.shared_normals[all.sharing[cell.ids[i]] & ~FinestVertices::shared_flag]);
  }
}

}  // namespace lodestone
