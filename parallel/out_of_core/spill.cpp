#include "parallel/out_of_core/spill.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "parallel/build/cell_numbers.h"
#include "parallel/build/cell_runs.h"
#include "parallel/mesh/vertex_sharing.h"

namespace lodestone {
namespace {

constexpr std::size_t write_triangles = std::size_t{1} << 16;  // about as many are written at once

// A cell's triangles in one part.
struct PartRun {
  std::uint32_t cell = 0;  // in order of appearance over all parts
  SpilledCells::Run run;
};

class Spilling {
 public:
  Spilling(const MeshStream& stream, const CleanStream& clean, int level, std::uint64_t part_triangles,
           std::span<std::uint32_t> sharing, ScratchFile& file, Scheduler& scheduler)
      : stream_(stream),
        clean_(clean),
        level_(level),
        sharing_(sharing),
        file_(file),
        scheduler_(scheduler),
        scratch_(static_cast<std::size_t>(scheduler.workers())),
        room_(std::min(part_triangles, stream.triangle_count())),
        memory_(std::make_unique_for_overwrite<std::byte[]>(room_ * sizeof(Triangle))),
        sorted_(reinterpret_cast<Triangle*>(memory_.get()), room_) {}

  [[nodiscard]] std::uint64_t room() const { return room_; }

  void spill(std::uint64_t first, std::uint64_t count) {
    std::vector<ChunkRuns> chunks = sort(first, count);
    for (const ChunkRuns& chunk : chunks) fingerprint_ += chunk.fingerprint;
    const std::vector<CellCode> codes = rank_cells(chunks);
    const RunTable table = gather_runs(chunks, codes.size());
    std::vector<std::uint32_t> cell;  // by rank in this part
    for (const CellCode code : codes) cell.push_back(cells_.number(code));
    write(table, cell);
  }

  [[nodiscard]] SpilledCells result() const {
    SpilledCells out;
    out.fingerprint = fingerprint_;
    out.codes = cells_.codes;
    std::vector<std::uint32_t> order(out.codes.size());  // cells by code
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return out.codes[a] < out.codes[b]; });
    std::vector<std::uint32_t> rank(order.size());
    for (std::uint32_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
    std::sort(out.codes.begin(), out.codes.end());
    out.first_run.assign(out.codes.size() + 1, 0);
    for (const PartRun& part : runs_) ++out.first_run[rank[part.cell] + 1];
    std::partial_sum(out.first_run.begin(), out.first_run.end(), out.first_run.begin());
    out.runs.resize(runs_.size());
    std::vector<std::uint64_t> next(out.first_run.begin(), out.first_run.end() - 1);
    for (const PartRun& part : runs_) out.runs[next[rank[part.cell]]++] = part.run;
    return out;
  }

 private:
  std::vector<ChunkRuns> sort(std::uint64_t first, std::uint64_t count) {
    std::vector<ChunkRuns> chunks(chunk_count(count, run_grain));
    scheduler_.for_chunks(count, run_grain, [&](ChunkRange range) {
      const std::vector<Triangle> triangles = clean_.read(stream_, first + range.begin, range.end - range.begin);
      chunks[range.index] = sort_to_runs(clean_.positions, triangles, level_, range.begin, sorted_,
                                         scratch_[static_cast<std::size_t>(scheduler_.worker_index())]);
    });
    return chunks;
  }

  // Moves the runs of the cells together, cells in Morton order, and claims the vertices.
  void write(const RunTable& table, std::span<const std::uint32_t> cell) {
    const std::uint64_t offset = file_.claim(table.first_triangle.back() * sizeof(Triangle));
    const std::vector<std::size_t> groups = group_cells(table);
    scheduler_.for_chunks(groups.size() - 1, 1, [&](ChunkRange range) {
      const std::size_t begin = groups[range.begin], end = groups[range.begin + 1];
      const std::uint64_t first = table.first_triangle[begin];
      std::vector<Triangle> triangles;
      triangles.reserve(table.first_triangle[end] - first);
      for (std::size_t c = begin; c < end; ++c)
        for (std::uint64_t r = table.first_run[c]; r < table.first_run[c + 1]; ++r)
          for (const Triangle& t : sorted_.subspan(table.runs[r].first, table.runs[r].count)) {
            for (const std::uint32_t v : t.v) claim_vertex(sharing_[v], cell[c]);
            triangles.push_back(t);
          }
      file_.write_at(offset + first * sizeof(Triangle), bytes_of(std::span<const Triangle>(triangles)));
    });
    for (std::size_t c = 0; c < cell.size(); ++c)
      runs_.push_back({cell[c],
                       {offset + table.first_triangle[c] * sizeof(Triangle),
                        table.first_triangle[c + 1] - table.first_triangle[c]}});
  }

  // Consecutive cells of about write_triangles: the first of each group, and the end.
  static std::vector<std::size_t> group_cells(const RunTable& table) {
    std::vector<std::size_t> groups{0};
    for (std::size_t c = 1; c + 1 < table.first_triangle.size(); ++c)
      if (table.first_triangle[c] - table.first_triangle[groups.back()] >= write_triangles) groups.push_back(c);
    if (table.first_triangle.size() > 1) groups.push_back(table.first_triangle.size() - 1);
    return groups;
  }

  const MeshStream& stream_;
  const CleanStream& clean_;
  int level_;
  std::span<std::uint32_t> sharing_;
  ScratchFile& file_;
  Scheduler& scheduler_;
  std::vector<RunScratch> scratch_;
  std::uint64_t room_;
  std::unique_ptr<std::byte[]> memory_;  // as bytes: a Triangle would be set to zero first
  std::span<Triangle> sorted_;           // of the part at hand
  CellNumbers cells_;                    // of all parts
  std::vector<PartRun> runs_;            // of all parts, in input order
  std::uint64_t fingerprint_ = 0;
};

}  // namespace

std::uint64_t SpilledCells::triangles_of(std::size_t cell) const {
  std::uint64_t count = 0;
  for (const Run& run : runs_of(cell)) count += run.count;
  return count;
}

void SpilledCells::read(const ScratchFile& file, std::size_t cell, std::span<Triangle> triangles) const {
  for (const Run& run : runs_of(cell)) {
    file.read_at(run.offset, std::as_writable_bytes(triangles.first(run.count)));
    triangles = triangles.subspan(run.count);
  }
}

SpilledCells spill_triangles(const MeshStream& stream, const CleanStream& clean, int level,
                             std::uint64_t part_triangles, std::span<std::uint32_t> sharing, ScratchFile& file,
                             Scheduler& scheduler, const std::function<void(std::uint64_t)>& done) {
  Spilling spilling(stream, clean, level, part_triangles, sharing, file, scheduler);
  for (std::uint64_t first = 0; first < stream.triangle_count(); first += spilling.room()) {
    spilling.spill(first, std::min(spilling.room(), stream.triangle_count() - first));
    if (done) done(std::min(first + spilling.room(), stream.triangle_count()));
  }
  return spilling.result();
}

}  // namespace lodestone
