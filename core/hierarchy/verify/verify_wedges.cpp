#include "core/hierarchy/verify/verify_wedges.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "core/base/disjoint_sets.h"

namespace lodestone::verify {
namespace {

constexpr std::uint32_t none = 0xffff'ffffu;

template <typename Body>
void for_vertices(const Hierarchy& hierarchy, int level, Body&& body) {
  std::uint32_t number = 0;
  CellId c = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    for (VertexId v{0}; v < cell.positions.size(); ++v) body(c, v, number++);
    ++c;
  }
}

// Without `vertex`.
LevelWedges identify(const Hierarchy& hierarchy, int level, const std::vector<VertexCopy>& copies) {
  LevelWedges result;
  result.first_cell = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  result.first_vertex.push_back(0);
  for (const Cell& cell : hierarchy.cells_of(level))
    result.first_vertex.push_back(result.first_vertex.back() + static_cast<std::uint32_t>(cell.positions.size()));
  result.identity.resize(result.first_vertex.back());
  for (std::uint32_t i = 0; i < result.identity.size(); ++i) result.identity[i] = i;
  for_runs(copies, [&](auto first, auto last) {
    for (auto copy = first; copy != last; ++copy)
      result.identity[result.number(copy->cell, copy->local)] = result.number(first->cell, first->local);
  });
  return result;
}

}  // namespace

LevelWedges finest_wedges(const Hierarchy& hierarchy, const std::vector<VertexCopy>& copies) {
  LevelWedges finest = identify(hierarchy, hierarchy.finest(), copies);
  struct Place {
    float x, y, z;
    std::uint32_t number;
    [[nodiscard]] auto key() const { return std::tie(x, y, z); }  // -0 == +0
  };
  std::vector<Place> places;
  for_vertices(hierarchy, hierarchy.finest(), [&](CellId c, VertexId v, std::uint32_t number) {
    const Vec3f p = hierarchy.cells[c].positions[v];
    if (finest.identity[number] == number) places.push_back({p.x, p.y, p.z, number});
  });
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.x, a.y, a.z, a.number) < std::tie(b.x, b.y, b.z, b.number);
  });
  finest.vertex = finest.identity;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i].key() == places[i - 1].key()) finest.vertex[places[i].number] = finest.vertex[places[i - 1].number];
  for (std::size_t n = 0; n < finest.vertex.size(); ++n) finest.vertex[n] = finest.vertex[finest.identity[n]];
  return finest;
}

LevelWedges coarser_wedges(const Hierarchy& hierarchy, int level, const LevelWedges& fine,
                           const std::vector<VertexCopy>& copies_above, Finding& wedges) {
  LevelWedges coarse = identify(hierarchy, level - 1, copies_above);
  DisjointSets groups(coarse.identity.size());
  for (std::uint32_t n = 0; n < groups.size(); ++n) groups.unite(n, coarse.identity[n]);
  struct Seen {
    std::uint32_t parent = none;
    Vec3f position;
  };
  std::vector<Seen> first(fine.vertex.size());  // of each finer vertex
  for_vertices(hierarchy, level, [&](CellId c, VertexId v, std::uint32_t number) {
    const Cell& cell = hierarchy.cells[c];
    const std::uint32_t parent = coarse.identity[coarse.number(cell.parent, cell.parents[v])];
    const Vec3f position = hierarchy.cells[cell.parent].positions[cell.parents[v]];
    Seen& seen = first[fine.vertex[number]];
    if (seen.parent == none) seen = {parent, position};
    wedges.require(seen.position == position, [&] {
      return place(level, c, v) + ": its parent has another position than that of another wedge there";
    });
    groups.unite(seen.parent, parent);
  });
  coarse.vertex.resize(groups.size());
  for (std::uint32_t n = 0; n < groups.size(); ++n) coarse.vertex[n] = groups.find(n);
  return coarse;
}

}  // namespace lodestone::verify
