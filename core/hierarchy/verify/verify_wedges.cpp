// Checks of hierarchies with attributes, where several stored vertices (wedges) stand at one position.
//
// Which wedges belong to one vertex is not stored. On the finest level it is told by their positions; from there on
// wedges are of one vertex when P takes wedges of one finer vertex to them.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/base/disjoint_sets.h"
#include "core/hierarchy/verify/verify_checks.h"

namespace lodestone::verify {
namespace {

constexpr std::uint32_t none = 0xffff'ffffu;

template <typename Body>
void for_vertices(const Hierarchy& hierarchy, int level, Body&& body) {
  std::uint32_t number = 0, c = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    for (std::uint32_t v = 0; v < cell.positions.size(); ++v) body(c, v, number++);
    ++c;
  }
}

void require_attributes(const Hierarchy& hierarchy, int level, Finding& wedges) {
  for_vertices(hierarchy, level, [&](std::uint32_t c, std::uint32_t v, std::uint32_t) {
    const CellAttributes& a = hierarchy.cells[c].attributes;
    if (!a.uv.empty())
      wedges.require(std::isfinite(a.uv[v].x) && std::isfinite(a.uv[v].y),
                     [&] { return place(level, c, v) + ": a texture coordinate is no number"; });
    if (!a.materials.empty())
      wedges.require(a.materials[v] == no_material || a.materials[v] < hierarchy.materials.size(),
                     [&] { return place(level, c, v) + ": there is no such material"; });
  });
}

// Corners of a triangle have one material, and P keeps it.
void require_materials_kept(const Hierarchy& hierarchy, int level, Finding& wedges) {
  const Level& cells = hierarchy.levels[static_cast<std::size_t>(level)];
  for (std::uint32_t c = cells.first_cell; c < cells.first_cell + cells.cell_count; ++c) {
    const Cell& cell = hierarchy.cells[c];
    const auto& materials = cell.attributes.materials;
    if (materials.empty()) return;
    for (const Triangle& t : cell.triangles)
      wedges.require(materials[t.v[0]] == materials[t.v[1]] && materials[t.v[1]] == materials[t.v[2]],
                     [&] { return place(level, c) + ": a triangle of several materials"; });
    if (level == 0) continue;
    // Only of vertices in use: the others may follow their vertex into another chart.
    const auto& above = hierarchy.cells[cell.parent].attributes.materials;
    for (const Triangle& t : cell.triangles)
      for (const std::uint32_t v : t.v)
        wedges.require(above[cell.parents[v]] == materials[v],
                       [&] { return place(level, c, v) + ": its parent has another material"; });
  }
}

}  // namespace

void group_by_position(const Hierarchy& hierarchy, LevelIdentity& finest) {
  struct Place {
    float x, y, z;
    std::uint32_t number;
    [[nodiscard]] auto key() const { return std::tie(x, y, z); }
  };
  std::vector<Place> places;
  for_vertices(hierarchy, hierarchy.finest(), [&](std::uint32_t c, std::uint32_t v, std::uint32_t number) {
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
}

void group_by_parents(const Hierarchy& hierarchy, int level, const LevelIdentity& fine, LevelIdentity& coarse,
                      Finding& wedges) {
  DisjointSets groups(coarse.identity.size());
  for (std::uint32_t n = 0; n < groups.size(); ++n) groups.unite(n, coarse.identity[n]);
  struct Seen {
    std::uint32_t parent = none;
    Vec3f position;
  };
  std::vector<Seen> first(fine.vertex.size());  // of each finer vertex
  for_vertices(hierarchy, level, [&](std::uint32_t c, std::uint32_t v, std::uint32_t number) {
    const Cell& cell = hierarchy.cells[c];
    const std::uint32_t parent = coarse.of(cell.parent, cell.parents[v]);
    const Vec3f position = hierarchy.cells[cell.parent].positions[cell.parents[v]];
    Seen& seen = first[fine.vertex[number]];
    if (seen.parent == none) seen = {parent, position};
    wedges.require(seen.position == position,
                   [&] { return place(level, c, v) + ": its parent lies elsewhere than that of another wedge there"; });
    groups.unite(seen.parent, parent);
  });
  coarse.vertex.resize(groups.size());
  for (std::uint32_t n = 0; n < groups.size(); ++n) coarse.vertex[n] = groups.find(n);
}

void check_wedges(const Hierarchy& hierarchy, Finding& wedges) {
  for (int level = 0; level <= hierarchy.finest(); ++level) {
    require_attributes(hierarchy, level, wedges);
    require_materials_kept(hierarchy, level, wedges);
  }
}

}  // namespace lodestone::verify
