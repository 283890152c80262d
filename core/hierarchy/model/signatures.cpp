#include "core/hierarchy/model/signatures.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace lodestone {
namespace {

using Cells = std::vector<CellId>;

struct CellsHash {
  std::size_t operator()(const Cells& cells) const {
    std::uint64_t hash = cells.size();
    for (const CellId cell : cells) hash = (hash ^ cell) * 0x9e37'79b9'7f4a'7c15u, hash ^= hash >> 32;
    return hash;
  }
};

// A copy of a shared vertex: where it is, in which cell, and the how many-th of that cell's shared vertices it is.
struct Copy {
  std::array<std::uint32_t, 3> position;  // bits; -0 is 0
  CellId cell;
  std::uint32_t vertex = 0;
};

std::vector<Copy> sorted_copies(const Hierarchy& hierarchy, const Level& level) {
  std::vector<Copy> copies;
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v == 0 ? 0.0f : v); };
  for (CellId cell = level.first_cell; cell < level.end_cell(); ++cell) {
    const Cell& c = hierarchy.cells[cell];
    for (std::uint32_t k = 0; k < c.shared_ids.size(); ++k) {
      const Vec3f p = c.positions[c.first_shared() + k];
      copies.push_back({{bits(p.x), bits(p.y), bits(p.z)}, cell, k});
    }
  }
  std::ranges::sort(copies, [](const Copy& a, const Copy& b) {
    return std::tie(a.position, a.cell, a.vertex) < std::tie(b.position, b.cell, b.vertex);
  });
  return copies;
}

// The sets of a level while they are being found: some may be united with others.
struct LevelSets {
  std::unordered_map<Cells, std::uint32_t, CellsHash> number_of;
  std::vector<Cells> sets;
  std::vector<std::uint32_t> joined;  // by set: the one that it became a part of, or itself

  std::uint32_t number(const Cells& cells) {
    const auto [found, is_new] = number_of.try_emplace(cells, static_cast<std::uint32_t>(sets.size()));
    if (is_new) joined.push_back(found->second), sets.push_back(cells);
    return found->second;
  }
  std::uint32_t final_of(std::uint32_t set) const {
    while (joined[set] != set) set = joined[set];
    return set;
  }
  // All of them become their union, in every cell.
  void unite(std::span<const std::uint32_t> some) {
    Cells all;
    for (const std::uint32_t set : some) all.insert(all.end(), sets[set].begin(), sets[set].end());
    std::ranges::sort(all);
    all.erase(std::ranges::unique(all).begin(), all.end());
    // The union may be a set that exists, and then that one may have become a part of another.
    const std::uint32_t to = final_of(number(all));
    for (const std::uint32_t set : some)
      if (const std::uint32_t from = final_of(set); from != to) joined[from] = to;
  }
};

void make_distinct(std::vector<std::uint32_t>& sets) {
  std::ranges::sort(sets);
  sets.erase(std::ranges::unique(sets).begin(), sets.end());
}

// Unites sets of cells that have more than `most`, until none has. Every union takes away one at least.
void limit(LevelSets& level, std::vector<std::vector<std::uint32_t>>& of_cell, std::size_t most) {
  for (bool united = true; united;) {
    united = false;
    for (std::vector<std::uint32_t>& sets : of_cell) {
      for (std::uint32_t& set : sets) set = level.final_of(set);
      // A cell alone stays alone: it is the set of all that lies inside the cell, and the first of its list.
      make_distinct(sets);
      const auto shared = std::ranges::partition(sets, [&](std::uint32_t set) { return level.sets[set].size() == 1; });
      if (sets.size() <= most) continue;
      const std::size_t excess = sets.size() - most + 1;
      std::ranges::sort(shared);
      level.unite(std::span(sets).last(std::min(excess, shared.size())));
      united = true;
    }
  }
}

}  // namespace

Signatures::Signatures(const Hierarchy& hierarchy, std::size_t most_in_cell) {
  assert(most_in_cell >= 2 && most_in_cell <= most);
  for (int level = 0; level <= hierarchy.finest(); ++level) add_level(hierarchy, level, most_in_cell);
  first_of_level_.push_back(static_cast<std::uint32_t>(first_cell_.size() - 1));
}

void Signatures::add_set(const Hierarchy& hierarchy, std::span<const CellId> cells) {
  for (const CellId cell : cells) {
    cells_.push_back(cell);
    // Cells of a level are in Morton order, and so are their parents.
    const CellId parent = hierarchy.cells[cell].parent;
    if (parent != no_cell && (parents_.size() == first_parent_.back() || parents_.back() != parent))
      parents_.push_back(parent);
  }
  first_cell_.push_back(cells_.size());
  first_parent_.push_back(parents_.size());
}

void Signatures::add_level(const Hierarchy& hierarchy, int number, std::size_t most_in_cell) {
  const Level& level = hierarchy.levels[static_cast<std::size_t>(number)];
  const std::vector<Copy> copies = sorted_copies(hierarchy, level);
  LevelSets found;
  std::vector<std::vector<std::uint32_t>> of_cell(level.cell_count);  // its sets
  std::vector<std::vector<std::uint32_t>> of_vertex(level.cell_count);
  for (CellId cell = level.first_cell; cell < level.end_cell(); ++cell) {
    of_cell[level.rank_of(cell)].push_back(found.number({cell}));
    of_vertex[level.rank_of(cell)].resize(hierarchy.cells[cell].shared_ids.size());
  }
  Cells users;
  for (std::size_t begin = 0, end = 0; begin < copies.size(); begin = end) {
    users.clear();
    for (; end < copies.size() && copies[end].position == copies[begin].position; ++end)
      if (users.empty() || users.back() != copies[end].cell) users.push_back(copies[end].cell);
    const std::uint32_t set = found.number(users);
    for (std::size_t k = begin; k < end; ++k) {
      of_vertex[level.rank_of(copies[k].cell)][copies[k].vertex] = set;
      of_cell[level.rank_of(copies[k].cell)].push_back(set);
    }
  }
  limit(found, of_cell, most_in_cell);

  // In the order in which the cells name them.
  first_of_level_.push_back(static_cast<std::uint32_t>(first_cell_.size() - 1));
  constexpr std::uint32_t unnamed = ~std::uint32_t{0};
  std::vector<std::uint32_t> named(found.sets.size(), unnamed);
  for (std::uint32_t rank = 0; rank < level.cell_count; ++rank) {
    for (const std::uint32_t set : of_cell[rank]) {
      if (named[set] == unnamed) {
        named[set] = static_cast<std::uint32_t>(first_cell_.size() - 1);
        add_set(hierarchy, found.sets[set]);
      }
      cell_sets_.push_back(named[set]);
    }
    first_set_.push_back(cell_sets_.size());
    for (const std::uint32_t set : of_vertex[rank]) {
      const auto place = std::ranges::find(of_cell[rank], found.final_of(set));
      places_.push_back(static_cast<std::uint8_t>(place - of_cell[rank].begin()));
    }
    first_place_.push_back(places_.size());
  }
}

}  // namespace lodestone
