#include "core/hierarchy/model/find_signatures.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/hierarchy/model/signature_sets.h"

namespace lodestone {
namespace {

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

// Writes the set of every copy of the part, as a number within it, to set_of.
CellSets find_sets(const Copies& copies, std::span<const std::uint32_t> part, const Level& level,
                   std::span<std::uint32_t> set_of) {
  BorderCopies of_part;
  std::size_t rank = 0;
  for (const std::uint32_t copy : part) {
    while (copies.first[rank + 1] <= copy) ++rank;
    const std::size_t k = copy - copies.first[rank];
    of_part.positions.push_back(copies.by_cell[rank].positions[k]);
    of_part.cells.push_back(level.id_of(CellRank(rank)));
    of_part.errors.push_back(copies.by_cell[rank].error(k));
    of_part.numbers.push_back(copy);
  }
  std::vector<std::uint32_t> found(part.size());
  CellSets sets = find_cell_sets(of_part, found);
  for (std::size_t i = 0; i < part.size(); ++i) set_of[part[i]] = found[i];
  return sets;
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
  std::vector<CellSets> parts(copies.parts());
  runner_.run(parts.size(),
              [&](std::size_t p, std::size_t) { parts[p] = find_sets(copies, copies.part(p), level, set_of); });
  const LevelSignatures found(parts, level, most_);
  runner_.run(parts.size(), [&](std::size_t p, std::size_t) {
    for (const std::uint32_t copy : copies.part(p))
      if (set_of[copy] != no_set) set_of[copy] = found.number(p, set_of[copy]);
  });
  found.append_to(table_);
  const std::size_t first_place = table_.places.size();
  table_.places.resize(first_place + set_of.size());
  runner_.run(groups.count(), [&](std::size_t group, std::size_t) {
    for (std::size_t rank = groups.begin(group); rank < groups.end(group); ++rank) {
      const std::uint32_t first = copies.first[rank], count = copies.first[rank + 1] - first;
      find_places(found.of(CellRank(rank)), std::span(set_of).subspan(first, count),
                  std::span(table_.places).subspan(first_place + first, count));
    }
  });
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
