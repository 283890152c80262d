#include "parallel/hierarchy/cell_runs.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/prefetch.h"
#include "core/hierarchy/model/fingerprint.h"
#include "core/math/lanes/float4.h"

namespace lodestone {
namespace {

constexpr std::size_t grain = 1 << 16;  // triangles of a chunk: its cells then have numbers of 16 bits

// The cells of all chunks in Morton order; the runs get the ranks of theirs.
std::vector<CellCode> rank_cells(std::vector<ChunkRuns>& chunks) {
  CellNumbers all;
  for (ChunkRuns& chunk : chunks)
    for (Run& run : chunk.runs) run.cell = all.number(chunk.codes[run.cell]);
  std::vector<CellCode> codes(all.keys().begin(), all.keys().end());
  std::sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> rank(codes.size());
  for (std::uint32_t c = 0; c < codes.size(); ++c) rank[all.number(codes[c])] = c;
  for (ChunkRuns& chunk : chunks)
    for (Run& run : chunk.runs) run.cell = rank[run.cell];
  return codes;
}

}  // namespace

CellRuns gather_runs(std::vector<ChunkRuns>&& chunks) {
  CellRuns out;
  out.codes = rank_cells(chunks);
  out.first_run.assign(out.codes.size() + 1, 0);
  out.first_triangle.assign(out.codes.size() + 1, 0);
  for (const ChunkRuns& chunk : chunks) {
    out.fingerprint += chunk.fingerprint;
    for (const Run& run : chunk.runs) {
      ++out.first_run[run.cell + 1];
      out.first_triangle[run.cell + 1] += run.count;
    }
  }
  std::partial_sum(out.first_run.begin(), out.first_run.end(), out.first_run.begin());
  std::partial_sum(out.first_triangle.begin(), out.first_triangle.end(), out.first_triangle.begin());
  out.runs.resize(out.first_run.back());
  std::vector<std::uint64_t> next(out.first_run.begin(), out.first_run.end() - 1);
  for (const ChunkRuns& chunk : chunks)
    for (const Run& run : chunk.runs) out.runs[next[run.cell]++] = run;
  return out;
}

CellRuns RunSorter::sort(std::uint64_t count, const Read& read, std::span<Triangle> sorted) {
  std::vector<ChunkRuns> chunks(chunk_count(count, grain));
  scheduler_.for_chunks(count, grain, [&](ChunkRange range) {
    Scratch& s = scratch_[static_cast<std::size_t>(scheduler_.worker_index())];
    chunks[range.index] = sort_chunk(read(range, s.triangles), range.begin, sorted, s);
  });
  return gather_runs(std::move(chunks));
}

// The cell of every triangle of the chunk, as a number within the chunk, counted. Returns the sum of the fingerprints.
std::uint64_t RunSorter::number_cells(std::span<const Triangle> triangles, Scratch& s) const {
  s.cells.clear(s.cells.size());  // chunks have similar numbers of them
  s.next.clear();
  s.number.resize(triangles.size());
  std::uint64_t fingerprint = 0;
  std::uint32_t number = 0;
  // The cell is mostly that of the previous triangle: equal whole parts of the barycentre in units of cells. Same
  // operations as in `barycentre` and `cell_of`, since scaling by a power of two rounds nothing.
  const Float4 per_cell = all4(1.0f / 3.0f * static_cast<float>(1u << level_));
  Int4 last{-1, -1, -1, -1};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[std::min(t + prefetch_distance, triangles.size() - 1)].v)
      prefetch(&positions_[v]);
    const auto& v = triangles[t].v;
    const Vec3f &a = positions_[v[0]], &b = positions_[v[1]], &c = positions_[v[2]];
    const Int4 whole = __builtin_convertvector(((to_float4(a) + to_float4(b)) + to_float4(c)) * per_cell, Int4);
    if (!equal(whole, last)) {
      last = whole;
      number = s.cells.number(CellCode::from(cell_of(barycentre(a, b, c), level_)));
      if (number == s.next.size()) s.next.push_back(0);
    }
    s.number[t] = static_cast<std::uint16_t>(number);
    ++s.next[number];
    fingerprint += triangle_fingerprint(a, b, c);
  }
  return fingerprint;
}

ChunkRuns RunSorter::sort_chunk(std::span<const Triangle> triangles, std::uint64_t first, std::span<Triangle> sorted,
                                Scratch& s) const {
  ChunkRuns chunk;
  chunk.fingerprint = number_cells(triangles, s);
  chunk.codes.assign(s.cells.keys().begin(), s.cells.keys().end());
  chunk.runs.resize(chunk.codes.size());
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < chunk.runs.size(); ++i) {
    chunk.runs[i] = {first + next, s.next[i], i};
    next += std::exchange(s.next[i], next);
  }
  Triangle* const to = sorted.data() + first;
  for (std::size_t t = 0; t < triangles.size(); ++t) to[s.next[s.number[t]]++] = triangles[t];
  return chunk;
}

void collect_cell(const CellRuns& runs, CellRank rank, const TriangleSource& source, std::span<Triangle> out,
                  VertexNumbers& numbers, CellBuild& cell) {
  cell.triangles = out;
  numbers.clear(out.size() / 2 + out.size() / 8);  // of a closed surface, and some for the border
  for (const Run& run : runs.runs_of(rank)) {
    const std::span<const Triangle> triangles = source.read(run, out.first(run.count));
    numbers.number({triangles.data()->v.data(), 3 * triangles.size()}, out.data()->v.data());
    out = out.subspan(run.count);
  }
  cell.ids.assign(numbers.keys().begin(), numbers.keys().end());
}

}  // namespace lodestone
