// Signatures: for every vertex, the set of cells of its level that use it, drawn or not.
//
// With a radius for every cell the morph of a vertex depends on its signature alone (docs/decisions/0055), and a cell
// has few of them: one byte tells a shared vertex its own. They are in the .lode file, so that cells that are not in
// memory count, too; core/hierarchy/model/find_signatures.h finds them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

class Signatures {
 public:
  // A set of cells of one level, and their parents, both ascending without repetition; no parents at the root.
  struct Users {
    std::span<const CellId> cells, parents;
  };

  // Signatures that a cell may have; more are united until they fit. A vertex whose signature holds more cells than
  // use it is safe: all its copies still share one, and the constraint between radii covers all of its cells.
  static constexpr std::size_t most = 255;

  // The table that determines them: the sets of two cells and more, level by level from the root, those of a level in
  // lexicographic order, each once.
  struct Table {
    std::vector<std::uint32_t> sets;   // by level: their number
    std::vector<std::uint32_t> sizes;  // by set
    std::vector<CellId> cells;         // of all sets
    std::vector<float> errors;         // by set: error() of it
    std::vector<std::uint8_t> places;  // by cell, by shared vertex: its place in of(cell)
    friend bool operator==(const Table&, const Table&) = default;
  };
  // Returns what keeps the table from being one of this hierarchy, whose tables are enough; nullptr if nothing does.
  [[nodiscard]] static const char* fault(const Hierarchy& tables, const Table& table);
  // From a table that has no fault.
  Signatures(const Hierarchy& tables, Table table);
  [[nodiscard]] const Table& table() const { return table_; }

  // The signatures of a cell, ascending. The first is that of vertices that no other cell uses.
  [[nodiscard]] std::span<const std::uint32_t> of(CellId cell) const {
    return std::span(cell_sets_).subspan(first_set_[cell], first_set_[cell + 1] - first_set_[cell]);
  }
  // By shared vertex of the cell, in its order: index of its signature in of(cell).
  [[nodiscard]] std::span<const std::uint8_t> places(CellId cell) const {
    return std::span(table_.places).subspan(first_place_[cell], first_place_[cell + 1] - first_place_[cell]);
  }
  [[nodiscard]] Users users(std::uint32_t signature) const {
    const std::size_t s = signature;
    return {std::span(cells_).subspan(first_cell_[s], first_cell_[s + 1] - first_cell_[s]),
            std::span(parents_).subspan(first_parent_[s], first_parent_[s + 1] - first_parent_[s])};
  }
  // An estimate or bound of the error of the triangles around vertices of this signature, in all of its cells; 0 for
  // those of one cell, which has an error itself.
  [[nodiscard]] float error(std::uint32_t signature) const { return errors_[signature]; }
  // All of a level are consecutive: [first(level), first(level + 1)), the first of them those of one cell, by rank.
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(errors_.size()); }
  [[nodiscard]] std::uint32_t first(int level) const { return first_of_level_[static_cast<std::size_t>(level)]; }

 private:
  void add_set(const Hierarchy& tables, std::span<const CellId> cells, float error);

  Table table_;
  std::vector<std::uint32_t> first_of_level_;
  std::vector<std::uint64_t> first_cell_{0}, first_parent_{0};  // by signature
  std::vector<CellId> cells_, parents_;
  std::vector<float> errors_;                           // likewise
  std::vector<std::uint64_t> first_set_, first_place_;  // by cell
  std::vector<std::uint32_t> cell_sets_;
};

}  // namespace lodestone
