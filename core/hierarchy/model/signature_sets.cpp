#include "core/hierarchy/model/signature_sets.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "core/base/key_numbers.h"
#include "core/base/sort_unique.h"

namespace lodestone {

std::uint64_t hash_of(std::span<const CellId> cells) {
  std::uint64_t hash = cells.size();
  for (const CellId cell : cells) hash = (hash ^ cell) * 0x9e37'79b9'7f4a'7c15u, hash ^= hash >> 32;
  return hash;
}

namespace {

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
  CellLists sets;
  std::vector<std::uint32_t> joined;  // by set: the one that it became a part of, or itself

  std::uint32_t number(std::span<const CellId> cells) {
    if (slots_.size() < 2 * sets.size() + 2) grow();
    std::uint32_t& slot = slot_of(cells);
    if (slot == no_set) {
      slot = static_cast<std::uint32_t>(sets.size());
      joined.push_back(slot);
      sets.add(cells);
    }
    return slot;
  }
  std::uint32_t final_of(std::uint32_t set) const {
    while (joined[set] != set) set = joined[set];
    return set;
  }
  // All of them become their union, in every cell.
  void unite(std::span<const std::uint32_t> some) {
    std::vector<CellId> all;
    for (const std::uint32_t set : some) all.insert(all.end(), sets[set].begin(), sets[set].end());
    sort_unique(all);
    // The union may be a set that exists, and then that one may have become a part of another.
    const std::uint32_t to = final_of(number(all));
    for (const std::uint32_t set : some)
      if (const std::uint32_t from = final_of(set); from != to) joined[from] = to;
  }

 private:
  // The slot that has the set, or would have it.
  std::uint32_t& slot_of(std::span<const CellId> cells) {
    return probe(slots_.data(), slots_.size() - 1, hash_of(cells),
                 [&](std::uint32_t slot) { return slot == no_set || std::ranges::equal(sets[slot], cells); });
  }
  void grow() {
    slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), no_set);
    for (std::uint32_t set = 0; set < sets.size(); ++set) slot_of(sets[set]) = set;
  }

  std::vector<std::uint32_t> slots_;  // a power of two of them, at least half of them empty: numbers of sets
};

// Unites sets of cells that have `most` of two cells and more, until none has: with that of the cell alone, which stays
// alone, they are `most` then. Every union takes away one at least.
void limit(LevelSets& level, std::vector<std::vector<std::uint32_t>>& of_cell, std::size_t most) {
  for (bool united = true; united;) {
    united = false;
    for (std::vector<std::uint32_t>& sets : of_cell) {
      for (std::uint32_t& set : sets) set = level.final_of(set);
      sort_unique(sets);
      if (sets.size() < most) continue;
      const std::size_t excess = sets.size() - most + 2;
      level.unite(std::span(sets).last(std::min(excess, sets.size())));
      united = true;
    }
  }
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

}  // namespace

CellSets find_cell_sets(const BorderCopies& copies, std::span<std::uint32_t> set_of) {
  const std::size_t count = copies.positions.size();
  std::vector<Position> positions(count);
  std::ranges::transform(copies.positions, positions.begin(), bits_of);
  std::vector<std::uint32_t> number(count);
  KeyNumbers<Position, PositionHash> numbers;
  numbers.clear(count / 2);
  numbers.number(positions, number.data());
  const Uses uses(number, copies.cells, numbers.size());
  LevelSets found;
  CellSets out;
  std::vector<std::uint32_t> set_of_position;  // of those seen so far
  for (std::size_t i = 0; i < count; ++i) {
    if (number[i] == set_of_position.size()) {
      const std::span<const CellId> users = uses.of(number[i]);
      const std::uint32_t set = users.size() > 1 ? found.number(users) : no_set;
      if (set == out.first.size()) out.first.push_back(copies.numbers[i]), out.errors.push_back(0);
      set_of_position.push_back(set);
    }
    const std::uint32_t set = set_of[i] = set_of_position[number[i]];
    if (set != no_set) out.errors[set] = std::max(out.errors[set], copies.errors[i]);
  }
  out.cells = std::move(found.sets);
  return out;
}

LevelSignatures::LevelSignatures(const std::vector<CellSets>& parts, const Level& level, std::size_t most)
    : of_cell_(level.cell_count) {
  struct First {
    std::uint64_t copy;
    std::uint32_t part, set;
  };
  std::vector<First> order;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    for (std::uint32_t s = 0; s < parts[p].first.size(); ++s) order.push_back({parts[p].first[s], p, s});
    number_.emplace_back(parts[p].first.size());
  }
  std::ranges::sort(order, {}, &First::copy);
  LevelSets found;
  for (const First& f : order) number_[f.part][f.set] = found.number(parts[f.part].cells[f.set]);
  for (std::uint32_t set = 0; set < found.sets.size(); ++set)
    for (const CellId cell : found.sets[set]) of_cell_[level.rank_of(cell)].push_back(set);
  limit(found, of_cell_, most);

  std::vector<std::uint32_t> left;
  for (const std::vector<std::uint32_t>& sets : of_cell_) left.insert(left.end(), sets.begin(), sets.end());
  sort_unique(left);
  std::ranges::sort(left, [&](std::uint32_t a, std::uint32_t b) {
    return std::ranges::lexicographical_compare(found.sets[a], found.sets[b]);
  });
  std::vector<std::uint32_t> final_number(found.sets.size());
  for (std::uint32_t k = 0; k < left.size(); ++k) {
    final_number[left[k]] = k;
    cells_.add(found.sets[left[k]]);
  }
  errors_.resize(left.size(), 0);
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::uint32_t s = 0; s < parts[p].first.size(); ++s) {
      std::uint32_t& number = number_[p][s];
      number = final_number[found.final_of(number)];
      errors_[number] = std::max(errors_[number], parts[p].errors[s]);
    }
  for (std::vector<std::uint32_t>& sets : of_cell_) {
    for (std::uint32_t& set : sets) set = final_number[set];
    std::ranges::sort(sets);
  }
}

void LevelSignatures::append_to(Signatures::Table& table) const {
  table.sets.push_back(static_cast<std::uint32_t>(cells_.size()));
  for (std::size_t set = 0; set < cells_.size(); ++set) {
    table.sizes.push_back(static_cast<std::uint32_t>(cells_[set].size()));
    table.cells.insert(table.cells.end(), cells_[set].begin(), cells_[set].end());
  }
  table.errors.insert(table.errors.end(), errors_.begin(), errors_.end());
}

void find_places(std::span<const std::uint32_t> own, std::span<const std::uint32_t> number_of,
                 std::span<std::uint8_t> places) {
  for (std::size_t k = 0; k < places.size(); ++k)
    places[k] = number_of[k] == no_set
                    ? std::uint8_t{0}
                    : static_cast<std::uint8_t>(1 + (std::ranges::lower_bound(own, number_of[k]) - own.begin()));
}

}  // namespace lodestone
