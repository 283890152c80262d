// Sets of cells that use the same positions, and the signatures of a level that follow from them
// (core/hierarchy/model/signatures.h): the steps of finding them, wherever the vertices are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/signatures.h"

namespace lodestone {

// Equal for equal sets, which are in ascending order.
[[nodiscard]] std::uint64_t hash_of(std::span<const CellId> cells);

// Vertices of a level that cells share, a copy for each cell that has one: all copies of each of some positions.
struct BorderCopies {
  std::vector<Vec3f> positions;
  std::vector<CellId> cells;           // does not descend
  std::vector<float> errors;           // of the surface around it within the cell
  std::vector<std::uint64_t> numbers;  // ascending: by cell, then by vertex within it, among all copies of the level
};

// Lists of cells, by number, one after the other in memory.
class CellLists {
 public:
  [[nodiscard]] std::size_t size() const { return end_.size(); }
  [[nodiscard]] std::span<const CellId> operator[](std::size_t list) const {
    const std::size_t begin = list == 0 ? 0 : end_[list - 1];
    return std::span(cells_).subspan(begin, end_[list] - begin);
  }
  // `cells` are not of these lists.
  void add(std::span<const CellId> cells) {
    cells_.insert(cells_.end(), cells.begin(), cells.end());
    end_.push_back(cells_.size());
  }

 private:
  std::vector<std::size_t> end_;  // by list
  std::vector<CellId> cells_;
};

// Distinct sets of two cells and more, in the order of their first copies.
struct CellSets {
  CellLists cells;                   // by set: ascending, each once
  std::vector<std::uint64_t> first;  // by set: the number of its first copy
  std::vector<float> errors;         // by set: the largest of its copies
};
inline constexpr std::uint32_t no_set = ~std::uint32_t{0};  // where no other cell uses a position

// Writes the set of every copy to set_of. Vertices are told apart by their positions, of which -0 is 0.
[[nodiscard]] CellSets find_cell_sets(const BorderCopies& copies, std::span<std::uint32_t> set_of);

// The signatures of a level, numbered in lexicographic order. The same for any way to part its copies.
class LevelSignatures {
 public:
  // `parts`: the sets of all copies of the level. A cell has at most `most` signatures, from 2 on, that of itself
  // alone included: sets are united until it does.
  LevelSignatures(const std::vector<CellSets>& parts, const Level& level, std::size_t most);

  [[nodiscard]] std::uint32_t number(std::size_t part, std::uint32_t set) const { return number_[part][set]; }
  [[nodiscard]] std::span<const std::uint32_t> of(CellRank cell) const { return of_cell_[cell]; }  // ascending
  void append_to(Signatures::Table& table) const;                                                  // all but the places

 private:
  std::vector<std::vector<std::uint32_t>> number_;   // by part, by set
  std::vector<std::vector<std::uint32_t>> of_cell_;  // by rank
  CellLists cells_;                                  // by number
  std::vector<float> errors_;                        // by number
};

// The places of a cell's shared vertices in the table, by the numbers of their sets; `own`: those of the cell,
// ascending.
void find_places(std::span<const std::uint32_t> own, std::span<const std::uint32_t> number_of,
                 std::span<std::uint8_t> places);

}  // namespace lodestone
