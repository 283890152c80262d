// Local ids of a cell's vertices by stamps: a vertex remembers the cell that has claimed it first and its id there, so
// that only vertices that another cell has claimed, those of borders, are searched for.
//
// Which of several cells a vertex belongs to depends on the schedule, the ids do not: they are given in order of
// appearance. One worker takes three quarters of the time of a table of all vertices of a cell
// (docs/decisions/0064-build-second-round.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "parallel/hierarchy/cell_runs.h"

namespace lodestone {

class VertexStamps {
 public:
  // Ids have 16 bits here: the most triangles that a cell may have.
  static constexpr std::size_t most_triangles = 0xffff / 3;

  // One worker's memory, reused between cells.
  struct Scratch {
    VertexNumbers numbers;
    std::vector<std::uint32_t> foreign;  // local id by number
    std::vector<std::uint32_t> ids;
  };

  // `sharing` as claim_vertex has it, by vertex, unowned at first; `alone`: only one worker claims.
  VertexStamps(std::span<std::uint32_t> sharing, bool alone)
      : sharing_(sharing), id_(std::make_unique_for_overwrite<std::uint16_t[]>(sharing.size())), alone_(alone) {}

  // As the function collect_cell with the room cell.triangles, at most most_triangles; claims the vertices, too. Once
  // for each cell, since its own claims tell it what it has numbered.
  void collect_cell(const CellRuns& runs, CellRank rank, const TriangleSource& source, Scratch& scratch,
                    CellBuild& cell);

 private:
  template <bool alone>
  std::uint32_t number_corners(std::span<const Triangle> triangles, CellRank rank, std::uint32_t count,
                               Scratch& scratch, Triangle* to);
  std::uint32_t number_foreign(std::uint32_t v, std::uint32_t count, Scratch& scratch);

  std::span<std::uint32_t> sharing_;
  std::unique_ptr<std::uint16_t[]> id_;  // by vertex, in the cell that has claimed it
  bool alone_;
};

}  // namespace lodestone
