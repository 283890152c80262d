#include "parallel/out_of_core/spill.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "parallel/mesh/vertex_sharing.h"

namespace lodestone {
namespace {

constexpr std::size_t write_triangles = std::size_t{1} << 16;  // about as many are written at once

// Consecutive cells of about write_triangles: the first of each group, and the end.
std::vector<std::size_t> group_cells(const CellRuns& runs) {
  std::vector<std::size_t> groups{0};
  for (std::size_t c = 1; c < runs.codes.size(); ++c)
    if (runs.first_triangle[c] - runs.first_triangle[groups.back()] >= write_triangles) groups.push_back(c);
  if (!runs.codes.empty()) groups.push_back(runs.codes.size());
  return groups;
}

class Spilling {
 public:
  Spilling(std::span<std::uint32_t> sharing, ScratchFile& file, Scheduler& scheduler)
      : sharing_(sharing), file_(file), scheduler_(scheduler) {}

  // Moves the runs of the cells of a part together, cells in Morton order, and claims the vertices.
  void write(CellRuns&& part, std::span<const Triangle> sorted) {
    std::vector<std::uint32_t> cell;  // by rank in this part: its number in all parts
    for (const CellCode code : part.codes) cell.push_back(cells_.number(code));
    const std::uint64_t offset = file_.claim(part.first_triangle.back() * sizeof(Triangle));
    const std::vector<std::size_t> groups = group_cells(part);
    scheduler_.for_chunks(groups.size() - 1, 1, [&](ChunkRange range) {
      const std::size_t begin = groups[range.begin], end = groups[range.begin + 1];
      const std::uint64_t first = part.first_triangle[begin];
      std::vector<Triangle> triangles;
      triangles.reserve(part.first_triangle[end] - first);
      for (CellRank c(begin); c < end; ++c)
        for (const Run& run : part.runs_of(c))
          for (const Triangle& t : sorted.subspan(run.first, run.count)) {
            for (const std::uint32_t v : t.v) claim_vertex(sharing_[v], cell[c]);
            triangles.push_back(t);
          }
      file_.write_at(offset + first * sizeof(Triangle), std::as_bytes(std::span(triangles)));
    });
    // The part as one chunk, a run for each of its cells.
    ChunkRuns written{std::move(part.codes), {}, part.fingerprint};
    for (CellRank c{0}; c < written.codes.size(); ++c)
      written.runs.push_back(
          {offset / sizeof(Triangle) + part.first_triangle[c], static_cast<std::uint32_t>(part.triangles_of(c)), c});
    parts_.push_back(std::move(written));
  }

  [[nodiscard]] CellRuns result() && { return gather_runs(std::move(parts_)); }

 private:
  std::span<std::uint32_t> sharing_;
  ScratchFile& file_;
  Scheduler& scheduler_;
  CellNumbers cells_;             // of all parts
  std::vector<ChunkRuns> parts_;  // in input order
};

}  // namespace

CellRuns spill_triangles(const MeshStream& stream, const CleanStream& clean, const SpillConfig& config,
                         std::span<std::uint32_t> sharing, ScratchFile& file, Scheduler& scheduler) {
  const std::uint64_t all = stream.triangle_count(), room = std::min(config.part_triangles, all);
  // As bytes: a Triangle would be set to zero first.
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(room * sizeof(Triangle));
  const std::span sorted(reinterpret_cast<Triangle*>(memory.get()), room);
  RunSorter sorter(clean.positions, config.grid, scheduler);
  Spilling spilling(sharing, file, scheduler);
  for (std::uint64_t first = 0; first < all; first += room) {
    const auto read = [&](ChunkRange range, std::vector<Triangle>& triangles) {
      triangles = clean.read(stream, first + range.begin, range.end - range.begin);
      return std::span<const Triangle>(triangles);
    };
    spilling.write(sorter.sort(std::min(room, all - first), read, sorted), sorted);
    if (config.progress) config.progress(std::min(first + room, all));
  }
  return std::move(spilling).result();
}

}  // namespace lodestone
