#include "core/hierarchy/model/find_signatures.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/base/key_numbers.h"

namespace lodestone {
namespace {

using Cells = std::vector<CellId>;

// Both transparent, so that a set is looked up without a copy of it.
struct CellsHash {
  using is_transparent = void;
  std::size_t operator()(std::span<const CellId> cells) const {
    std::uint64_t hash = cells.size();
    for (const CellId cell : cells) hash = (hash ^ cell) * 0x9e37'79b9'7f4a'7c15u, hash ^= hash >> 32;
    return hash;
  }
};

struct SameCells {
  using is_transparent = void;
  bool operator()(std::span<const CellId> a, std::span<const CellId> b) const { return std::ranges::equal(a, b); }
};

// Bits; -0 is 0. Compared without a branch: most positions are there already.
struct Position {
  std::uint32_t x, y, z;
  bool operator==(const Position& o) const { return ((x ^ o.x) | (y ^ o.y) | (z ^ o.z)) == 0; }
};

struct PositionHash {
  std::uint64_t operator()(const Position& p) const {
    constexpr std::uint64_t odd = 0x9e37'79b9'7f4a'7c15u;
    std::uint64_t hash = (p.x | std::uint64_t{p.y} << 32) * odd;
    hash ^= hash >> 32;
    return (hash ^ p.z) * odd;
  }
};

Position bits_of(Vec3f p) {
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v == 0 ? 0.0f : v); };
  return {bits(p.x), bits(p.y), bits(p.z)};
}

// Distinct sets of cells by number: some may be united with others.
struct LevelSets {
  std::unordered_map<Cells, std::uint32_t, CellsHash, SameCells> number_of;
  std::vector<Cells> sets;
  std::vector<std::uint32_t> joined;  // by set: the one that it became a part of, or itself

  std::uint32_t number(std::span<const CellId> cells) {
    if (const auto found = number_of.find(cells); found != number_of.end()) return found->second;
    const auto next = static_cast<std::uint32_t>(sets.size());
    joined.push_back(next);
    number_of.emplace(sets.emplace_back(cells.begin(), cells.end()), next);
    return next;
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

// Unites sets of cells that have `most` of two cells and more, until none has: with that of the cell alone, which stays
// alone, they are `most` then. Every union takes away one at least.
void limit(LevelSets& level, std::vector<std::vector<std::uint32_t>>& of_cell, std::size_t most) {
  for (bool united = true; united;) {
    united = false;
    for (std::vector<std::uint32_t>& sets : of_cell) {
      for (std::uint32_t& set : sets) set = level.final_of(set);
      std::ranges::sort(sets);
      sets.erase(std::ranges::unique(sets).begin(), sets.end());
      if (sets.size() < most) continue;
      const std::size_t excess = sets.size() - most + 2;
      level.unite(std::span(sets).last(std::min(excess, sets.size())));
      united = true;
    }
  }
}

// The users of every position of a level: `of[number]` cells from `first`, ascending.
struct Uses {
  std::vector<std::uint32_t> number;  // by copy of a shared vertex: of its position
  std::vector<std::size_t> first;     // by number, and the end
  std::vector<CellId> cells;

  [[nodiscard]] std::span<const CellId> of(std::uint32_t n) const {
    return std::span(cells).subspan(first[n], first[n + 1] - first[n]);
  }
};

Uses uses_of(const Level& level, std::span<const std::vector<SharedVertex>> shared) {
  Uses uses;
  const std::size_t copies = std::transform_reduce(shared.begin(), shared.end(), std::size_t{0}, std::plus{},
                                                   [](const auto& of_cell) { return of_cell.size(); });
  uses.number.resize(copies);
  KeyNumbers<Position, PositionHash> numbers;
  numbers.clear(copies / 2);
  std::vector<Position> keys;
  auto number = uses.number.begin();
  for (const std::vector<SharedVertex>& of_cell : shared) {
    keys.clear();
    for (const SharedVertex& v : of_cell) {
      keys.push_back(bits_of(v.position));
      numbers.prefetch(keys.back());
    }
    numbers.number(keys, std::to_address(number));
    number += static_cast<std::ptrdiff_t>(keys.size());
  }
  std::vector<std::uint32_t> last(numbers.size(), no_cell);
  uses.first.assign(numbers.size() + 1, 0);
  const auto for_uses = [&](const auto& visit) {  // of a position by a cell, once
    std::ranges::fill(last, std::uint32_t{no_cell});
    number = uses.number.begin();
    for (std::size_t rank = 0; rank < shared.size(); ++rank)
      for (std::size_t k = 0; k < shared[rank].size(); ++k, ++number)
        if (std::exchange(last[*number], static_cast<std::uint32_t>(rank)) != rank)
          visit(*number, level.id_of(CellRank(rank)));
  };
  for_uses([&](std::uint32_t n, CellId) { ++uses.first[n + 1]; });
  std::partial_sum(uses.first.begin(), uses.first.end(), uses.first.begin());
  uses.cells.resize(uses.first.back());
  std::vector<std::size_t> next(uses.first.begin(), uses.first.end() - 1);
  for_uses([&](std::uint32_t n, CellId cell) { uses.cells[next[n]++] = cell; });
  return uses;
}

}  // namespace

SignatureFinder::SignatureFinder(const Hierarchy& tables, std::size_t most) : tables_(tables), most_(most) {
  assert(most >= 2 && most <= Signatures::most);
}

void SignatureFinder::begin_level() { shared_.assign(level().cell_count, {}); }

void SignatureFinder::add(CellId id, const Cell& cell) {
  const std::span<const Vec3f> positions = cell.positions.subspan(cell.first_shared());
  std::vector<SharedVertex>& shared = shared_[level().rank_of(id)];
  shared.reserve(positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k)
    shared.push_back({positions[k], cell.border_errors.empty() ? tables_.cells[id].error : cell.border_errors[k]});
}

void SignatureFinder::end_level() {
  const Level& level = this->level();
  const Uses uses = uses_of(level, shared_);
  LevelSets found;
  std::vector<std::vector<std::uint32_t>> of_cell(level.cell_count);  // its sets of two cells and more
  constexpr std::uint32_t alone = ~std::uint32_t{0};
  std::vector<std::uint32_t> set_of(uses.first.size() - 1, alone);  // by number of a position
  for (std::uint32_t n = 0; n < set_of.size(); ++n) {
    const std::span<const CellId> cells = uses.of(n);
    if (cells.size() == 1) continue;
    set_of[n] = found.number(cells);
    for (const CellId cell : cells)
      if (auto& sets = of_cell[level.rank_of(cell)]; sets.empty() || sets.back() != set_of[n])
        sets.push_back(set_of[n]);
  }
  limit(found, of_cell, most_);

  // Numbered in lexicographic order.
  std::vector<std::uint32_t> order;
  for (const std::vector<std::uint32_t>& sets : of_cell) order.insert(order.end(), sets.begin(), sets.end());
  std::ranges::sort(order);
  order.erase(std::ranges::unique(order).begin(), order.end());
  std::ranges::sort(order, {}, [&](std::uint32_t set) -> const Cells& { return found.sets[set]; });
  std::vector<std::uint32_t> rank_of(found.sets.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    rank_of[order[k]] = k;
    const Cells& cells = found.sets[order[k]];
    table_.sizes.push_back(static_cast<std::uint32_t>(cells.size()));
    table_.cells.insert(table_.cells.end(), cells.begin(), cells.end());
  }
  const std::size_t first_error = table_.errors.size();
  table_.errors.resize(table_.sizes.size(), 0);
  auto number = uses.number.begin();
  for (std::size_t rank = 0; rank < shared_.size(); ++rank) {
    std::vector<std::uint32_t>& sets = of_cell[rank];
    for (std::uint32_t& set : sets) set = rank_of[set];
    std::ranges::sort(sets);
    for (std::size_t k = 0; k < shared_[rank].size(); ++k) {
      const std::uint32_t set = set_of[*number++];
      if (set == alone) {
        table_.places.push_back(0);
        continue;
      }
      const std::uint32_t final = rank_of[found.final_of(set)];
      table_.places.push_back(static_cast<std::uint8_t>(1 + (std::ranges::lower_bound(sets, final) - sets.begin())));
      table_.errors[first_error + final] = std::max(table_.errors[first_error + final], shared_[rank][k].error);
    }
  }
  table_.sets.push_back(static_cast<std::uint32_t>(order.size()));
  shared_.clear();
}

Signatures find_signatures(const Hierarchy& hierarchy, std::size_t most) {
  SignatureFinder finder(hierarchy, most);
  for (const Level& level : hierarchy.levels) {
    finder.begin_level();
    for (CellId c = level.first_cell; c < level.end_cell(); ++c) finder.add(c, hierarchy.cells[c]);
    finder.end_level();
  }
  return std::move(finder).finish();
}

std::shared_ptr<const Signatures> signatures_of(const Hierarchy& hierarchy) {
  return hierarchy.signatures ? hierarchy.signatures : std::make_shared<const Signatures>(find_signatures(hierarchy));
}

}  // namespace lodestone
