// Each peer gets all that belongs to some vertices: stored vertices go to the peer of their position's hash, the wedges
// of a finer vertex to that of its number. Parents that these tie together have one position, so that the sets of such
// parents are found at that position's peer.
#include "core/hierarchy/verify/verify_wedges.h"

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/disjoint_sets.h"
#include "core/base/key_numbers.h"

namespace lodestone::verify {
namespace {

// A vertex as a cell stores it. `identity` is the same for its copies: the shared id, or, of no other cell, a number
// beyond all ids.
struct Stored {
  Vec3f position;
  std::uint32_t number;
  std::uint64_t identity;
  CellId cell;
  std::uint32_t local, peer;  // that it comes from
};

// A stored vertex by its finer vertex, and its parent.
struct Child {
  std::uint32_t vertex, number;
  Vec3f position;  // of the parent
  CellId cell;
  std::uint64_t identity;  // of the parent
};

// Identities of stored vertices at one position that are wedges of one vertex.
struct Tie {
  Vec3f position;
  std::uint64_t first, second;
};

// The answer about a stored vertex.
struct Named {
  CellId cell;
  std::uint32_t local, vertex;
};

std::uint64_t identity_of(const Cell& cell, std::uint32_t local, std::uint32_t number) {
  constexpr std::uint64_t beyond_ids = std::uint64_t{1} << 32;
  return local < cell.first_shared() ? beyond_ids + number : cell.shared_ids[local - cell.first_shared()];
}

// Those of the cells that are here or have children here, where their positions meet: a cell's may come from two peers.
std::vector<Stored> stored_vertices(const Part& part, int level, const LevelWedges& wedges) {
  std::vector<Stored> all;
  all.reserve(wedges.size());
  for (CellId c = part.level(level).first_cell; c < part.level(level).end_cell(); ++c) {
    if (!wedges.has(c)) continue;
    const Cell& cell = part.hierarchy.cells[c];
    for (std::uint32_t v = 0; v < cell.positions.size(); ++v) {
      const std::uint32_t number = wedges.number(c, v);
      all.push_back(
          {cell.positions[v], number, identity_of(cell, v, number), c, v, static_cast<std::uint32_t>(part.index())});
    }
  }
  return part.sort_out(std::move(all), [](const Stored& s) { return key_of(s.position); });
}

// Tells every peer the vertices of the stored ones that have come from it: vertex_of(i) of the i-th.
template <class VertexOf>
void name_vertices(const Part& part, const std::vector<Stored>& stored, const VertexOf& vertex_of,
                   LevelWedges& wedges) {
  std::vector<std::vector<Named>> out(part.peers());
  for (std::size_t i = 0; i < stored.size(); ++i)
    out[stored[i].peer].push_back({stored[i].cell, stored[i].local, vertex_of(i)});
  for (const std::vector<Named>& of_peer : part.exchange(out))
    for (const Named& named : of_peer) wedges.set_vertex(named.cell, named.local, named.vertex);
}

// The children whose finer vertices meet at this peer, by vertex and then by number.
std::vector<Child> children(const Part& part, int level, const LevelWedges& fine, const LevelWedges& coarse) {
  std::vector<Child> all;
  all.reserve(fine.size());
  part.for_cells(level, [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    const Cell& above = part.hierarchy.cells[cell.parent];
    for (std::uint32_t v = 0; v < cell.positions.size(); ++v) {
      const std::uint32_t p = cell.parents[v];
      all.push_back({fine.vertex(c, v), fine.number(c, v), above.positions[p], c,
                     identity_of(above, p, coarse.number(cell.parent, p))});
    }
  });
  all = part.sort_out(std::move(all), [](const Child& child) { return child.vertex; });
  std::sort(all.begin(), all.end(),
            [](const Child& a, const Child& b) { return std::tie(a.vertex, a.number) < std::tie(b.vertex, b.number); });
  return all;
}

}  // namespace

LevelWedges::LevelWedges(const Part& part, int level) : first_cell_(part.level(level).first_cell) {
  std::uint32_t number = 0, place = 0;
  for (CellId c = first_cell_; c < part.level(level).end_cell(); ++c) {
    const Cell& cell = part.hierarchy.cells[c];
    const auto size = static_cast<std::uint32_t>(cell.positions.size());
    number_.push_back(number);
    number += size;
    const bool here = part.has(c) || (cell.child_count > 0 && part.has(cell.first_child));
    place_.push_back(here ? place : nowhere);
    if (here) place += size;
  }
  vertex_.resize(place);
}

LevelWedges finest_wedges(const Part& part) {
  LevelWedges finest(part, part.hierarchy.finest());
  std::vector<Stored> stored = stored_vertices(part, part.hierarchy.finest(), finest);
  const auto key = [](const Stored& s) { return std::tie(s.position.x, s.position.y, s.position.z); };  // -0 == +0
  std::sort(stored.begin(), stored.end(), [&](const Stored& a, const Stored& b) {
    return std::tuple(key(a), a.number) < std::tuple(key(b), b.number);
  });
  std::uint32_t vertex = 0;
  name_vertices(
      part, stored,
      [&](std::size_t i) {
        if (i == 0 || key(stored[i - 1]) != key(stored[i])) vertex = stored[i].number;
        return vertex;
      },
      finest);
  return finest;
}

LevelWedges coarser_wedges(const Part& part, int level, const LevelWedges& fine, Finding& wedges) {
  LevelWedges coarse(part, level - 1);
  std::vector<Tie> ties;
  const std::vector<Child> all = children(part, level, fine, coarse);
  for (auto first = all.begin(), child = first; child != all.end(); ++child) {
    if (child->vertex != first->vertex) first = child;
    const bool same = first->position == child->position;
    wedges.require(same, [&] {
      return place(level, child->cell, VertexId(child->number - fine.number(child->cell, 0))) +
             ": its parent has another position than that of another wedge there";
    });
    if (same && first->identity != child->identity) ties.push_back({first->position, first->identity, child->identity});
  }
  ties = part.sort_out(std::move(ties), [](const Tie& tie) { return key_of(tie.position); });

  const std::vector<Stored> stored = stored_vertices(part, level - 1, coarse);
  KeyNumbers<std::uint64_t> identities;
  identities.clear(stored.size());
  std::vector<std::uint32_t> of_stored;
  for (const Stored& s : stored) of_stored.push_back(identities.number(s.identity));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> tied;
  for (const Tie& tie : ties) tied.emplace_back(identities.number(tie.first), identities.number(tie.second));
  DisjointSets sets(identities.size());
  for (const auto& [a, b] : tied) sets.unite(a, b);
  std::vector<std::uint32_t> lowest(sets.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    std::uint32_t& number = lowest[sets.find(of_stored[i])];
    number = std::min(number, stored[i].number);
  }
  name_vertices(
      part, stored, [&](std::size_t i) { return lowest[sets.find(of_stored[i])]; }, coarse);
  return coarse;
}

}  // namespace lodestone::verify
