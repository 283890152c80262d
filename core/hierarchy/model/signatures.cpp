#include "core/hierarchy/model/signatures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace lodestone {
namespace {

// Calls visit(level, cells) for the sets of the table, as long as it returns true.
template <class Visit>
bool for_sets(const Signatures::Table& table, const Visit& visit) {
  std::size_t set = 0, cell = 0;
  for (std::size_t level = 0; level < table.sets.size(); ++level)
    for (std::uint32_t k = 0; k < table.sets[level]; ++k) {
      const std::span cells = std::span(table.cells).subspan(cell, table.sizes[set]);
      if (!visit(level, cells)) return false;
      cell += table.sizes[set++];
    }
  return true;
}

template <class Items>
std::uint64_t sum(const Items& items) {
  std::uint64_t total = 0;
  for (const auto item : items) total += item;
  return total;
}

}  // namespace

const char* Signatures::fault(const Hierarchy& tables, const Table& table) {
  if (table.sets.size() != tables.levels.size() || sum(table.sets) != table.sizes.size() ||
      table.errors.size() != table.sizes.size() || sum(table.sizes) != table.cells.size())
    return "the signatures have wrong sizes";
  std::vector<std::uint16_t> count(tables.cells.size(), 1);  // of each cell
  std::span<const CellId> last;
  std::size_t last_level = 0;
  const bool valid = for_sets(table, [&](std::size_t number, std::span<const CellId> cells) {
    const Level& level = tables.levels[number];
    if (cells.size() < 2 || cells.front() < level.first_cell || cells.back() >= level.end_cell()) return false;
    if (std::ranges::adjacent_find(cells, std::ranges::greater_equal{}) != cells.end()) return false;
    if (!last.empty() && last_level == number && !std::ranges::lexicographical_compare(last, cells)) return false;
    last = cells, last_level = number;
    return std::ranges::all_of(cells, [&](CellId cell) { return ++count[cell] <= most; });
  });
  if (!valid) return "a signature is invalid";
  if (!std::ranges::all_of(table.errors, [](float e) { return e >= 0 && std::isfinite(e); }))
    return "the error of a signature is negative or not finite";
  std::size_t place = 0;
  for (std::size_t c = 0; c < tables.cells.size(); ++c) {
    const std::size_t end = place + tables.cells[c].shared_ids.size();
    if (end > table.places.size()) break;
    for (; place < end; ++place)
      if (table.places[place] >= count[c]) return "the signature of a shared vertex is out of range";
  }
  return place == table.places.size() ? nullptr : "the number of signatures is not that of the shared vertices";
}

Signatures::Signatures(const Hierarchy& tables, Table table) : table_(std::move(table)) {
  assert(!fault(tables, table_));
  const std::size_t cell_count = tables.cells.size();
  const auto begin_level = [&](std::size_t level) {
    first_of_level_.push_back(static_cast<std::uint32_t>(first_cell_.size() - 1));
    for (CellId c = tables.levels[level].first_cell; c < tables.levels[level].end_cell(); ++c)
      add_set(tables, std::span(&c, 1), 0);
  };
  std::size_t set = 0;
  (void)for_sets(table_, [&](std::size_t level, std::span<const CellId> cells) {
    while (first_of_level_.size() <= level) begin_level(first_of_level_.size());
    add_set(tables, cells, table_.errors[set++]);
    return true;
  });
  while (first_of_level_.size() < tables.levels.size()) begin_level(first_of_level_.size());
  const auto signatures = static_cast<std::uint32_t>(first_cell_.size() - 1);
  first_of_level_.push_back(signatures);

  // A signature belongs to all of its cells, and is added to theirs in ascending order.
  first_set_.assign(cell_count + 1, 0);
  for (const CellId cell : cells_) ++first_set_[cell + 1];
  for (std::size_t c = 0; c < cell_count; ++c) first_set_[c + 1] += first_set_[c];
  cell_sets_.resize(cells_.size());
  std::vector<std::uint64_t> next(first_set_.begin(), first_set_.end() - 1);
  for (std::uint32_t s = 0; s < signatures; ++s)
    for (const CellId cell : users(s).cells) cell_sets_[next[cell]++] = s;
  first_place_.reserve(cell_count + 1);
  first_place_.push_back(0);
  for (const Cell& cell : tables.cells) first_place_.push_back(first_place_.back() + cell.shared_ids.size());
}

void Signatures::add_set(const Hierarchy& tables, std::span<const CellId> cells, float error) {
  errors_.push_back(error);
  for (const CellId cell : cells) {
    cells_.push_back(cell);
    // Cells of a level are in Morton order, and so are their parents.
    const CellId parent = tables.cells[cell].parent;
    if (parent != no_cell && (parents_.size() == first_parent_.back() || parents_.back() != parent))
      parents_.push_back(parent);
  }
  first_cell_.push_back(cells_.size());
  first_parent_.push_back(parents_.size());
}

}  // namespace lodestone
