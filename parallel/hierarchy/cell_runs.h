// Triangles sorted to runs of one cell each, and where the runs of every cell are.
//
// A scatter of all triangles to all cells misses caches and the TLB when the input comes in random order. So triangles
// of a chunk go to runs of one cell each, while the chunk is in the second-level cache; the runs of a cell, in the
// order of chunks, are the cell's triangles in input order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/id.h"
#include "core/base/key_numbers.h"
#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/model/cell_code.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// The cells of a stretch of the input, and the vertices of a cell.
struct CellCodeHash {
  [[nodiscard]] std::uint64_t operator()(CellCode code) const { return FibonacciHash{}(code.morton); }
};
using CellNumbers = KeyNumbers<CellCode, CellCodeHash>;
using VertexNumbers = KeyNumbers<std::uint32_t>;

// Consecutive triangles of one cell.
struct Run {
  std::uint64_t first = 0;  // triangle, in an array or in a file
  std::uint32_t count = 0;
  std::uint32_t cell = 0;  // number within its chunk, then rank among the cells of all chunks
};

struct ChunkRuns {
  std::vector<CellCode> codes;  // by number
  std::vector<Run> runs;
  std::uint64_t fingerprint = 0;  // sum of triangle_fingerprint over the triangles
};

// Places of the triangles of all cells.
struct CellRuns {
  std::vector<CellCode> codes;                // occupied cells, ascending
  std::vector<std::uint64_t> first_run;       // by cell, one more than cells
  std::vector<Run> runs;                      // by cell, in the order of chunks
  std::vector<std::uint64_t> first_triangle;  // by cell, one more than cells
  std::uint64_t fingerprint = 0;

  [[nodiscard]] std::span<const Run> runs_of(CellRank cell) const {
    return std::span(runs).subspan(first_run[cell], first_run[cell + 1] - first_run[cell]);
  }
  [[nodiscard]] std::uint64_t triangles_of(CellRank cell) const {
    return first_triangle[cell + 1] - first_triangle[cell];
  }
};

// Brings the runs of all chunks together by cell.
[[nodiscard]] CellRuns gather_runs(std::vector<ChunkRuns>&& chunks);

// Sorts triangles by the cell of `level` that contains their barycentre.
class RunSorter {
 public:
  RunSorter(std::span<const Vec3f> positions, int level, Scheduler& scheduler)
      : positions_(positions),
        level_(level),
        scheduler_(scheduler),
        scratch_(static_cast<std::size_t>(scheduler.workers())) {}

  // Returns triangles [range.begin, range.end) of the input, or what is left of them; `room` may hold them.
  using Read = std::function<std::span<const Triangle>(ChunkRange range, std::vector<Triangle>& room)>;
  // Copies `count` triangles to runs in `sorted`, which has room for as many.
  [[nodiscard]] CellRuns sort(std::uint64_t count, const Read& read, std::span<Triangle> sorted);

 private:
  // One worker's memory for the chunk at hand.
  struct Scratch {
    CellNumbers cells;
    std::vector<std::uint16_t> number;  // by triangle
    std::vector<std::uint32_t> next;    // by cell: first how many triangles, then where the next one goes
    std::vector<Triangle> triangles;
  };
  [[nodiscard]] std::uint64_t number_cells(std::span<const Triangle> triangles, Scratch& s) const;
  [[nodiscard]] ChunkRuns sort_chunk(std::span<const Triangle> triangles, std::uint64_t first,
                                     std::span<Triangle> sorted, Scratch& s) const;

  std::span<const Vec3f> positions_;
  int level_;
  Scheduler& scheduler_;
  std::vector<Scratch> scratch_;
};

// Gives access to sorted triangles: in memory or in a file.
class TriangleSource {
 public:
  virtual ~TriangleSource() = default;
  // The triangles of a run; `room` has room for them. From any thread.
  [[nodiscard]] virtual std::span<const Triangle> read(const Run& run, std::span<Triangle> room) const = 0;
};

// Brings the triangles of a cell together in `out`, in input order, with local ids. Sets the cell's `triangles` and
// `ids`: the input vertices that the local ids stand for, in order of appearance.
void collect_cell(const CellRuns& runs, CellRank rank, const TriangleSource& source, std::span<Triangle> out,
                  VertexNumbers& numbers, CellBuild& cell);

}  // namespace lodestone
