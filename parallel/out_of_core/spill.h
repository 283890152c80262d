// Triangles of a stream sorted by cell of the finest level, in a scratch file: an external counting sort.
//
// As many triangles as there is memory for are sorted to the runs of their cells at a time (parallel/build/cell_runs.h) and
// written in Morton order of the cells. A cell's triangles are then a run from each such part, in input order.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/files/scratch_file.h"
#include "core/hierarchy/model/cell_code.h"
#include "parallel/out_of_core/mesh_stream.h"
#include "parallel/out_of_core/stream_clean.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Where the triangles of the cells are.
struct SpilledCells {
  struct Run {
    std::uint64_t offset = 0;  // in the scratch file, in bytes
    std::uint64_t count = 0;   // triangles
  };
  std::vector<CellCode> codes;           // occupied cells, ascending
  std::vector<std::uint64_t> first_run;  // by cell, one more than cells
  std::vector<Run> runs;                 // by cell, in input order
  std::uint64_t fingerprint = 0;         // sum of triangle_fingerprint over the triangles

  [[nodiscard]] std::span<const Run> runs_of(std::size_t cell) const {
    return std::span(runs).subspan(first_run[cell], first_run[cell + 1] - first_run[cell]);
  }
  [[nodiscard]] std::uint64_t triangles_of(std::size_t cell) const;
  // Into triangles.size() == triangles_of(cell).
  void read(const ScratchFile& file, std::size_t cell, std::span<Triangle> triangles) const;
};

// Sorts what `clean` leaves of the stream, part_triangles at a time, and claims each vertex
// for each cell that uses it: `sharing` has a word per vertex that is left, see parallel/mesh/vertex_sharing.h. Memory: 12
// bytes per triangle of a part, three mebibytes per worker, 16 bytes per run. `done` is called with how many triangles
// of the stream have been dealt with, from time to time.
[[nodiscard]] SpilledCells spill_triangles(const MeshStream& stream, const CleanStream& clean, int level,
                                           std::uint64_t part_triangles, std::span<std::uint32_t> sharing,
                                           ScratchFile& file, Scheduler& scheduler,
                                           const std::function<void(std::uint64_t)>& done = {});

}  // namespace lodestone
