// Checks of identities and of the parent relation.
//
// In hierarchies with attributes several stored vertices (wedges) have one position. The wedges of one vertex are not
// stored: on the finest level they follow from their positions; on coarser ones wedges belong to one vertex when P maps
// wedges of one finer vertex to them.
#include <algorithm>
#include <cstring>
#include <tuple>

#include "core/base/disjoint_sets.h"
#include "core/hierarchy/verify/verify_checks.h"

namespace lodestone::verify {
namespace {

constexpr std::uint32_t none = 0xffff'ffffu;

using Shared = LevelIdentity::Shared;

bool same_bits(Vec3f a, Vec3f b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

// Calls body(first, last) for each run of copies of one vertex in `shared`.
template <typename Body>
void for_runs(const std::vector<Shared>& shared, Body&& body) {
  for (auto first = shared.begin(); first != shared.end();) {
    const auto last = std::find_if(first, shared.end(), [&](const Shared& s) { return s.id != first->id; });
    body(first, last);
    first = last;
  }
}

template <typename Body>
void for_vertices(const Hierarchy& hierarchy, int level, Body&& body) {
  std::uint32_t number = 0;
  CellId c = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    for (VertexId v{0}; v < cell.positions.size(); ++v) body(c, v, number++);
    ++c;
  }
}

// Position of the first copy of a vertex.
struct Place {
  float x, y, z;
  std::uint32_t number;
  [[nodiscard]] auto key() const { return std::tie(x, y, z); }  // -0 == +0
};

// The places of a level, by position, then by number.
std::vector<Place> sorted_places(const Hierarchy& hierarchy, int level, const LevelIdentity& identity) {
  std::vector<Place> places;
  for_vertices(hierarchy, level, [&](CellId c, VertexId v, std::uint32_t number) {
    const Vec3f p = hierarchy.cells[c].positions[v];
    if (identity.identity[number] == number) places.push_back({p.x, p.y, p.z, number});
  });
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.x, a.y, a.z, a.number) < std::tie(b.x, b.y, b.z, b.number);
  });
  return places;
}

// The same triangle, rotated so that its smallest vertex comes first; its orientation is kept.
Triangle rotated(Triangle t) {
  std::rotate(t.v.begin(), std::min_element(t.v.begin(), t.v.end()), t.v.end());
  return t;
}

bool before(const Triangle& a, const Triangle& b) { return a.v < b.v; }

std::string name_of(const Triangle& t) {
  return std::to_string(t.v[0]) + " " + std::to_string(t.v[1]) + " " + std::to_string(t.v[2]);
}

}  // namespace

LevelIdentity identify(const Hierarchy& hierarchy, int level) {
  LevelIdentity result;
  result.first_cell = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  result.first_vertex.push_back(0);
  CellId c = result.first_cell;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    const std::uint32_t first = result.first_vertex.back();
    for (std::uint32_t k = 0; k < cell.shared_ids.size(); ++k) {
      const VertexId local(cell.first_shared() + k);
      result.shared.push_back({cell.shared_ids[k], c, local, first + local});
    }
    result.first_vertex.push_back(first + static_cast<std::uint32_t>(cell.positions.size()));
    ++c;
  }
  result.identity.resize(result.first_vertex.back());
  for (std::uint32_t i = 0; i < result.identity.size(); ++i) result.identity[i] = i;
  std::sort(result.shared.begin(), result.shared.end(),
            [](const Shared& a, const Shared& b) { return std::tie(a.id, a.number) < std::tie(b.id, b.number); });
  for_runs(result.shared, [&](auto first, auto last) {
    for (auto copy = first; copy != last; ++copy) result.identity[copy->number] = first->number;
  });
  return result;
}

void check_copies(const Hierarchy& hierarchy, int level, const LevelIdentity& fine, Finding& identity) {
  for_runs(fine.shared, [&](auto first, auto last) {
    const auto where = [&] { return place(level, first->cell, first->local) + ", id " + std::to_string(first->id); };
    // A wedge may be shared because another wedge of its vertex is.
    identity.require(last - first >= 2 || hierarchy.attributes.wedges,
                     [&] { return where() + ": shared, but in one cell only"; });
    const Cell& one = hierarchy.cells[first->cell];
    for (auto copy = first + 1; copy < last; ++copy) {
      const Cell& other = hierarchy.cells[copy->cell];
      identity.require(copy->cell != (copy - 1)->cell, [&] { return where() + ": twice in one cell"; });
      identity.require(same_bits(one.positions[first->local], other.positions[copy->local]),
                       [&] { return where() + ": copies at different positions"; });
      identity.require(one.normals[first->local] == other.normals[copy->local],
                       [&] { return where() + ": copies with different normals"; });
    }
  });
}

// One identity has one position (check_copies), so it is enough that different identities have different positions.
void check_positions_distinct(const Hierarchy& hierarchy, const LevelIdentity& finest, Finding& identity) {
  const std::vector<Place> places = sorted_places(hierarchy, hierarchy.finest(), finest);
  for (std::size_t i = 1; i < places.size(); ++i)
    identity.require(places[i - 1].key() != places[i].key(), [&] {
      const auto cell_of_number = [&](std::uint32_t n) {
        const auto after = std::upper_bound(finest.first_vertex.begin(), finest.first_vertex.end(), n);
        return finest.first_cell + static_cast<std::uint32_t>(after - finest.first_vertex.begin()) - 1;
      };
      return "cells " + std::to_string(cell_of_number(places[i - 1].number)) + " and " +
             std::to_string(cell_of_number(places[i].number)) + ": two vertices of the finest level at one position";
    });
}

void check_ids_kept(const Hierarchy& hierarchy, const LevelIdentity& fine, const LevelIdentity& coarse,
                    Finding& identity) {
  auto above = coarse.shared.begin();
  for_runs(fine.shared, [&](auto first, auto) {
    above = std::find_if(above, coarse.shared.end(), [&](const Shared& s) { return s.id >= first->id; });
    if (above == coarse.shared.end() || above->id != first->id) return;
    const Cell& cell = hierarchy.cells[first->cell];
    identity.require(coarse.of(cell.parent, VertexId(cell.parents[first->local])) == coarse.identity[above->number],
                     [&] {
                       return "id " + std::to_string(first->id) + " of cell " + std::to_string(first->cell) +
                              " and of cell " + std::to_string(above->cell) + ": not the same vertex under P";
                     });
  });
}

void check_parent_function(const Hierarchy& hierarchy, int level, const LevelIdentity& fine,
                           const LevelIdentity& coarse, Finding& parents) {
  const auto parent_of = [&](const Shared& copy) {
    const Cell& cell = hierarchy.cells[copy.cell];
    return coarse.of(cell.parent, VertexId(cell.parents[copy.local]));
  };
  for_runs(fine.shared, [&](auto first, auto last) {
    for (auto copy = first + 1; copy < last; ++copy)
      parents.require(parent_of(*copy) == parent_of(*first), [&] {
        return place(level, copy->cell, copy->local) + ", id " + std::to_string(copy->id) +
               ": another parent than in cell " + std::to_string(first->cell);
      });
  });
}

// Ids local to a cell name its vertices one to one (check_copies), so sets and multisets are compared on local ids.
void check_images(const Hierarchy& hierarchy, int coarse_level, const LevelIdentity& coarse, Finding& vertices,
                  Finding& triangles) {
  std::vector<char> reached;
  std::vector<Triangle> images, stored;
  const Level& level = hierarchy.levels[static_cast<std::size_t>(coarse_level)];
  for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
    const Cell& cell = hierarchy.cells[c];
    reached.assign(cell.positions.size(), 0);
    images.clear();
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
      const Cell& child = hierarchy.cells[k];
      for (const std::uint32_t parent : child.parents) reached[parent] = 1;
      for (const Triangle& t : child.triangles) {
        const Triangle image{{child.parents[t.v[0]], child.parents[t.v[1]], child.parents[t.v[2]]}};
        const auto vertex = [&](std::size_t i) { return coarse.vertex_of(c, VertexId(image.v[i])); };
        if (!is_degenerate({{vertex(0), vertex(1), vertex(2)}})) images.push_back(rotated(image));
      }
    }
    const auto missed = std::find(reached.begin(), reached.end(), 0);
    vertices.require(missed == reached.end(), [&] {
      return place(coarse_level, c, VertexId(missed - reached.begin())) + ": not the parent of any vertex";
    });

    stored.resize(cell.triangles.size());
    std::transform(cell.triangles.begin(), cell.triangles.end(), stored.begin(), rotated);
    std::sort(images.begin(), images.end(), before);
    std::sort(stored.begin(), stored.end(), before);
    triangles.require(images == stored, [&] {
      const auto length = std::min(images.size(), stored.size());
      const auto at = static_cast<std::size_t>(
          std::mismatch(images.begin(), images.begin() + static_cast<std::ptrdiff_t>(length), stored.begin()).first -
          images.begin());
      const bool extra = at == images.size() || (at < stored.size() && before(stored[at], images[at]));
      return place(coarse_level, c) + ", triangle " + name_of(extra ? stored[at] : images[at]) +
             (extra ? ": not the image of a triangle below" : ": image of a triangle below, but missing");
    });
  }
}

void group_by_position(const Hierarchy& hierarchy, LevelIdentity& finest) {
  const std::vector<Place> places = sorted_places(hierarchy, hierarchy.finest(), finest);
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
  for_vertices(hierarchy, level, [&](CellId c, VertexId v, std::uint32_t number) {
    const Cell& cell = hierarchy.cells[c];
    const std::uint32_t parent = coarse.of(cell.parent, VertexId(cell.parents[v]));
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
}

}  // namespace lodestone::verify
