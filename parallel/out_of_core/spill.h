// Triangles of a stream sorted by cell of the finest level, in a scratch file: an external counting sort.
//
// As many triangles as there is memory for are sorted to the runs of their cells at a time
// (parallel/hierarchy/cell_runs.h) and written in Morton order of the cells. A cell's triangles are then a run from
// each such part, in input order.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/files/scratch_file.h"
#include "parallel/clean/stream_clean.h"
#include "parallel/hierarchy/cell_runs.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Triangles in a scratch file.
class FileSource final : public TriangleSource {
 public:
  explicit FileSource(const ScratchFile& file) : file_(file) {}
  [[nodiscard]] std::span<const Triangle> read(const Run& run, std::span<Triangle> room) const override {
    file_.read_at(run.first * sizeof(Triangle), std::as_writable_bytes(room));
    return room;
  }

 private:
  const ScratchFile& file_;
};

struct SpillConfig {
  int grid = 0;                      // of the cells
  std::uint64_t part_triangles = 0;  // of the stream, sorted at a time; at least 1
  // Called with how many triangles of the stream have been dealt with, from time to time; may be empty.
  std::function<void(std::uint64_t)> progress{};
};

// Sorts what `clean` leaves of the stream into the file, which holds nothing else, and claims each vertex for each cell
// that uses it: `sharing` has a word per vertex that is left, see parallel/mesh/vertex_sharing.h. Memory: 12 bytes per
// triangle of a part, three mebibytes per worker, 16 bytes per run.
[[nodiscard]] CellRuns spill_triangles(const MeshStream& stream, const CleanStream& clean, const SpillConfig& config,
                                       std::span<std::uint32_t> sharing, ScratchFile& file, Scheduler& scheduler);

}  // namespace lodestone
