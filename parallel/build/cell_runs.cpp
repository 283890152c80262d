#include "parallel/build/cell_runs.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/prefetch.h"
#include "core/hierarchy/model/fingerprint.h"
#include "core/math/float4.h"

namespace lodestone {
namespace {

// The cell of every triangle of the chunk, as a number within the chunk, counted. Returns the sum of the fingerprints.
std::uint64_t number_cells(std::span<const Vec3f> positions, std::span<const Triangle> triangles, int level,
                           RunScratch& s) {
  s.cells.clear();
  s.next.clear();
  s.number.resize(triangles.size());
  std::uint64_t fingerprint = 0;
  std::uint32_t number = 0;
  // Mostly the cell is that of the triangle before: equal whole parts of the barycentre in units of cells. Same
  // operations as in `barycentre` and `cell_of`, since scaling by a power of two rounds nothing.
  const Float4 per_cell = all4(1.0f / 3.0f * static_cast<float>(1u << level));
  Int4 last{-1, -1, -1, -1};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[std::min(t + prefetch_distance, triangles.size() - 1)].v)
      prefetch(&positions[v]);
    const auto& v = triangles[t].v;
    const Vec3f &a = positions[v[0]], &b = positions[v[1]], &c = positions[v[2]];
    const Int4 whole = __builtin_convertvector(((to_float4(a) + to_float4(b)) + to_float4(c)) * per_cell, Int4);
    if (!equal(whole, last)) {
      last = whole;
      number = s.cells.number(CellCode::from(cell_of(barycentre(a, b, c), level)));
      if (number == s.next.size()) s.next.push_back(0);
    }
    s.number[t] = static_cast<std::uint16_t>(number);
    ++s.next[number];
    fingerprint += triangle_fingerprint(a, b, c);
  }
  return fingerprint;
}

}  // namespace

ChunkRuns sort_to_runs(std::span<const Vec3f> positions, std::span<const Triangle> triangles, int level,
                       std::uint64_t first, std::span<Triangle> sorted, RunScratch& s) {
  ChunkRuns chunk;
  chunk.fingerprint = number_cells(positions, triangles, level, s);
  chunk.codes.assign(s.cells.codes.begin(), s.cells.codes.end());
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

std::vector<CellCode> rank_cells(std::vector<ChunkRuns>& chunks) {
  CellNumbers all;
  for (ChunkRuns& chunk : chunks)
    for (Run& run : chunk.runs) run.cell = all.number(chunk.codes[run.cell]);
  std::vector<CellCode> codes = all.codes;
  std::sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> rank(codes.size());
  for (std::uint32_t c = 0; c < codes.size(); ++c) rank[all.number(codes[c])] = c;
  for (ChunkRuns& chunk : chunks)
    for (Run& run : chunk.runs) run.cell = rank[run.cell];
  return codes;
}

RunTable gather_runs(const std::vector<ChunkRuns>& chunks, std::size_t cells) {
  RunTable table;
  table.first_run.assign(cells + 1, 0);
  table.first_triangle.assign(cells + 1, 0);
  for (const ChunkRuns& chunk : chunks)
    for (const Run& run : chunk.runs) {
      ++table.first_run[run.cell + 1];
      table.first_triangle[run.cell + 1] += run.count;
    }
  std::partial_sum(table.first_run.begin(), table.first_run.end(), table.first_run.begin());
  std::partial_sum(table.first_triangle.begin(), table.first_triangle.end(), table.first_triangle.begin());
  table.runs.resize(table.first_run.back());
  std::vector<std::uint64_t> next(table.first_run.begin(), table.first_run.end() - 1);
  for (const ChunkRuns& chunk : chunks)
    for (const Run& run : chunk.runs) table.runs[next[run.cell]++] = run;
  return table;
}

}  // namespace lodestone
