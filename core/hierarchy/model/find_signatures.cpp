#include "core/hierarchy/model/find_signatures.h"

#include <algorithm>
#include <atomic>
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

// The copies of a level's shared vertices, numbered by cell, in parts of the positions that lie near each other: so the
// table of a part is small, and its sets are those of few other parts.
struct Copies {
  std::span<const BorderVertices> by_cell;
  std::vector<std::uint32_t> first;         // by rank, and the end
  std::vector<std::uint32_t> sorted;        // by part, ascending within one
  std::vector<std::uint32_t> first_sorted;  // by part, and the end

  [[nodiscard]] std::size_t parts() const { return first_sorted.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> part(std::size_t p) const {
    return std::span(sorted).subspan(first_sorted[p], first_sorted[p + 1] - first_sorted[p]);
  }
};

// Ranks of a level's cells, in as many groups as there are parts: their number depends on that of the cells alone.
class CellGroups {
 public:
  explicit CellGroups(std::size_t cells)
      : cells_(cells), of_group_(std::max(least, (cells + most_groups - 1) / most_groups)) {}
  [[nodiscard]] std::size_t count() const { return (cells_ + of_group_ - 1) / of_group_; }
  [[nodiscard]] std::size_t begin(std::size_t group) const { return group * of_group_; }
  [[nodiscard]] std::size_t end(std::size_t group) const { return std::min(cells_, begin(group + 1)); }
  using Part = std::uint8_t;

 private:
  static constexpr std::size_t least = 64, most_groups = 256;
  std::size_t cells_, of_group_;
};

// The part of a position is the group of the cell that it lies in, or of the one before it.
class PartFinder {
 public:
  PartFinder(std::span<const Cell> cells, const CellGroups& groups, int grid) : grid_(grid) {
    for (std::size_t g = 1; g < groups.count(); ++g) begin_.push_back(cells[groups.begin(g)].code);
  }
  [[nodiscard]] CellGroups::Part part_of(Vec3f position) const {
    const auto after = std::ranges::upper_bound(begin_, CellCode::from(cell_of(position, grid_)));
    return static_cast<CellGroups::Part>(after - begin_.begin());
  }

 private:
  int grid_;
  std::vector<CellCode> begin_;  // first cells of the groups, but for the first one
};

Copies sort_copies(std::span<const BorderVertices> by_cell, const PartFinder& finder, const CellGroups& groups,
                   const Runner& runner) {
  Copies out{by_cell, {0}, {}, {}};
  for (const BorderVertices& of_cell : by_cell)
    out.first.push_back(out.first.back() + static_cast<std::uint32_t>(of_cell.positions.size()));
  std::vector<CellGroups::Part> part(out.first.back());
  std::vector<std::vector<std::uint32_t>> next(groups.count());  // by group, by part: their number, then their place
  runner.run(groups.count(), [&](std::size_t group, std::size_t) {
    next[group].assign(groups.count(), 0);
    for (std::size_t rank = groups.begin(group); rank < groups.end(group); ++rank)
      for (std::size_t k = 0; k < by_cell[rank].positions.size(); ++k)
        ++next[group][part[out.first[rank] + k] = finder.part_of(by_cell[rank].positions[k])];
  });
  std::uint32_t sum = 0;
  for (std::size_t p = 0; p < groups.count(); ++p) {
    out.first_sorted.push_back(sum);
    for (std::vector<std::uint32_t>& of_group : next) sum += std::exchange(of_group[p], sum);
  }
  out.first_sorted.push_back(sum);
  out.sorted.resize(sum);
  runner.run(groups.count(), [&](std::size_t group, std::size_t) {
    for (std::uint32_t copy = out.first[groups.begin(group)]; copy < out.first[groups.end(group)]; ++copy)
      out.sorted[next[group][part[copy]]++] = copy;
  });
  return out;
}

// The cells of every position of a part: `of(number)`, ascending, each once.
class Uses {
 public:
  // By copy: the number of its position, and its cell, which does not descend.
  Uses(std::span<const std::uint32_t> number, std::span<const CellId> cell, std::size_t positions)
      : first_(positions + 1, 0) {
    std::vector<std::uint32_t> last(positions);
    const auto for_uses = [&](const auto& visit) {  // of a position by a cell, once
      std::ranges::fill(last, std::uint32_t{no_cell});
      for (std::size_t i = 0; i < number.size(); ++i)
        if (std::exchange(last[number[i]], std::uint32_t{cell[i]}) != cell[i]) visit(number[i], cell[i]);
    };
    for_uses([&](std::uint32_t n, CellId) { ++first_[n + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    cells_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for_uses([&](std::uint32_t n, CellId c) { cells_[next[n]++] = c; });
  }
  [[nodiscard]] std::span<const CellId> of(std::uint32_t n) const {
    return std::span(cells_).subspan(first_[n], first_[n + 1] - first_[n]);
  }

 private:
  std::vector<std::size_t> first_;  // by number, and the end
  std::vector<CellId> cells_;
};

constexpr std::uint32_t alone = ~std::uint32_t{0};  // instead of a set, where no other cell uses a position

// The sets of a part, in the order of their first copies.
struct PartSets {
  LevelSets found;
  std::vector<std::uint32_t> first_copy;    // by set
  std::vector<std::uint32_t> level_number;  // by set: among those of the level
};

// Writes the set of every copy of the part, as a number within it, to set_of.
PartSets find_sets(const Copies& copies, std::span<const std::uint32_t> part, const Level& level,
                   std::span<std::uint32_t> set_of) {
  std::vector<Position> positions(part.size());
  std::vector<CellId> cells(part.size());
  std::size_t rank = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    while (copies.first[rank + 1] <= part[i]) ++rank;
    cells[i] = level.id_of(CellRank(rank));
    positions[i] = bits_of(copies.by_cell[rank].positions[part[i] - copies.first[rank]]);
  }
  std::vector<std::uint32_t> number(part.size());
  KeyNumbers<Position, PositionHash> numbers;
  numbers.clear(part.size() / 2);
  numbers.number(positions, number.data());
  const Uses uses(number, cells, numbers.size());
  PartSets out;
  std::vector<std::uint32_t> set_of_position;  // of those seen so far
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (number[i] == set_of_position.size()) {
      const std::span<const CellId> users = uses.of(number[i]);
      const std::uint32_t set = users.size() > 1 ? out.found.number(users) : alone;
      if (set == out.first_copy.size()) out.first_copy.push_back(part[i]);
      set_of_position.push_back(set);
    }
    set_of[part[i]] = set_of_position[number[i]];
  }
  return out;
}

// The sets of all parts, numbered by their first copies, whatever the parts are.
LevelSets join(std::vector<PartSets>& parts) {
  struct First {
    std::uint32_t copy, part, set;
  };
  std::vector<First> order;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    for (std::uint32_t s = 0; s < parts[p].first_copy.size(); ++s) order.push_back({parts[p].first_copy[s], p, s});
    parts[p].level_number.resize(parts[p].first_copy.size());
  }
  std::ranges::sort(order, {}, &First::copy);
  LevelSets out;
  for (const First& f : order) parts[f.part].level_number[f.set] = out.number(parts[f.part].found.sets[f.set]);
  return out;
}

// Extends a maximum to which several workers contribute.
void raise(float& greatest, float value) {
  const std::atomic_ref at(greatest);
  for (float old = at.load(std::memory_order_relaxed); old < value;)
    if (at.compare_exchange_weak(old, value, std::memory_order_relaxed)) return;
}

}  // namespace

SignatureFinder::SignatureFinder(const Hierarchy& tables, std::size_t most, Runner runner)
    : tables_(tables), most_(most), runner_(std::move(runner)) {
  assert(most >= 2 && most <= Signatures::most);
}

void SignatureFinder::begin_level() { shared_.resize(level().cell_count); }

void SignatureFinder::add(CellId id, const Cell& cell) {
  BorderVertices& shared = shared_[level().rank_of(id)];
  shared.positions = cell.positions.subspan(cell.first_shared());
  shared.errors = cell.border_errors;
  shared.cell_error = tables_.cells[id].error;
}

void SignatureFinder::add_copy(CellId id, const Cell& cell) {
  add(id, cell);
  BorderVertices& shared = shared_[level().rank_of(id)];
  shared.own_positions.assign(shared.positions.begin(), shared.positions.end());
  shared.own_errors.assign(shared.errors.begin(), shared.errors.end());
  shared.positions = shared.own_positions;
  shared.errors = shared.own_errors;
}

void SignatureFinder::end_level() {
  const Level& level = this->level();
  const CellGroups groups(level.cell_count);
  const int number = static_cast<int>(table_.sets.size());
  const Copies copies =
      sort_copies(shared_, PartFinder(tables_.cells_of(number), groups, tables_.grids.of(number)), groups, runner_);
  std::vector<std::uint32_t> set_of(copies.sorted.size());  // by copy
  std::vector<PartSets> parts(copies.parts());
  runner_.run(parts.size(),
              [&](std::size_t p, std::size_t) { parts[p] = find_sets(copies, copies.part(p), level, set_of); });
  LevelSets found = join(parts);
  std::vector<std::vector<std::uint32_t>> of_cell(level.cell_count);  // its sets of two cells and more
  for (std::uint32_t set = 0; set < found.sets.size(); ++set)
    for (const CellId cell : found.sets[set]) of_cell[level.rank_of(cell)].push_back(set);
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
  runner_.run(parts.size(), [&](std::size_t p, std::size_t) {
    for (const std::uint32_t copy : copies.part(p))
      if (set_of[copy] != alone) set_of[copy] = rank_of[found.final_of(parts[p].level_number[set_of[copy]])];
  });

  const std::size_t first_error = table_.errors.size(), first_place = table_.places.size();
  table_.errors.resize(table_.sizes.size(), 0);
  table_.places.resize(first_place + set_of.size(), 0);
  runner_.run(groups.count(), [&](std::size_t group, std::size_t) {
    for (std::size_t rank = groups.begin(group); rank < groups.end(group); ++rank) {
      std::vector<std::uint32_t>& sets = of_cell[rank];
      for (std::uint32_t& set : sets) set = rank_of[set];
      std::ranges::sort(sets);
      for (std::uint32_t copy = copies.first[rank]; copy < copies.first[rank + 1]; ++copy) {
        const std::uint32_t set = set_of[copy];
        if (set == alone) continue;
        table_.places[first_place + copy] =
            static_cast<std::uint8_t>(1 + (std::ranges::lower_bound(sets, set) - sets.begin()));
        raise(table_.errors[first_error + set], shared_[rank].error(copy - copies.first[rank]));
      }
    }
  });
  table_.sets.push_back(static_cast<std::uint32_t>(order.size()));
  std::vector<BorderVertices>().swap(shared_);
}

Signatures find_signatures(const Hierarchy& hierarchy, std::size_t most) {
  SignatureFinder finder(hierarchy, most);
  for (const Level& level : hierarchy.levels) {
    finder.begin_level();
    for (CellId c = level.first_cell; c < level.end_cell(); ++c) finder.add(c, hierarchy.cells[c]);
    finder.end_level();
  }
  return {hierarchy, std::move(finder).finish()};
}

std::shared_ptr<const Signatures> signatures_of(const Hierarchy& hierarchy) {
  return hierarchy.signatures ? hierarchy.signatures : std::make_shared<const Signatures>(find_signatures(hierarchy));
}

}  // namespace lodestone
