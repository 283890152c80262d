// Triangles sorted to runs of one cell each, chunk by chunk, and where the runs of every cell are.
//
// A scatter of all triangles to all cells misses caches and the TLB when the input comes in random order. So triangles
// of a chunk go to runs of one cell each, while the chunk is in the second-level cache; the runs of a cell, in the
// order of chunks, are the cell's triangles in input order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/build/cell_numbers.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

inline constexpr std::size_t run_grain = 1 << 16;  // triangles of a chunk: its cells then have numbers of 16 bits

// Consecutive triangles of one cell.
struct Run {
  std::uint64_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t cell = 0;  // number within the chunk, then rank among the cells of all chunks
};

struct ChunkRuns {
  std::vector<CellCode> codes;  // by number
  std::vector<Run> runs;        // by number
  std::uint64_t fingerprint = 0;
};

// One worker's memory for the chunk at hand.
struct RunScratch {
  CellNumbers cells;
  std::vector<std::uint16_t> number;  // by triangle
  std::vector<std::uint32_t> next;    // by cell: first how many triangles, then where the next one goes
};

// Where the runs of every cell are.
struct RunTable {
  std::vector<std::uint64_t> first_run;       // by cell, one more than cells
  std::vector<Run> runs;                      // by cell, in the order of chunks
  std::vector<std::uint64_t> first_triangle;  // by cell, one more than cells
};

// Copies at most run_grain triangles to runs in sorted[first ...]; the fingerprint is the sum over them.
[[nodiscard]] ChunkRuns sort_to_runs(std::span<const Vec3f> positions, std::span<const Triangle> triangles, int level,
                                     std::uint64_t first, std::span<Triangle> sorted, RunScratch& scratch);

// The cells of all chunks in Morton order; runs learn the rank of theirs.
[[nodiscard]] std::vector<CellCode> rank_cells(std::vector<ChunkRuns>& chunks);

[[nodiscard]] RunTable gather_runs(const std::vector<ChunkRuns>& chunks, std::size_t cells);

}  // namespace lodestone
