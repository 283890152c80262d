// A counting sort in two steps, since a scatter of all triangles to all cells misses caches and the TLB when the input
// comes in random order: triangles of a chunk to *runs* of one cell each, while the chunk is in the second-level cache;
// then the runs of a cell, in the order of chunks, to the cell. The second step gives the vertices their local ids.
//
// This keeps the input order within a cell for any number of workers. What several workers add to one place is added
// with operations that commute exactly.
#include "parallel/partition.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/float4.h"
#include "core/base/prefetch.h"
#include "core/hierarchy/fingerprint.h"
#include "core/hierarchy/vertex_numbers.h"
#include "parallel/cell_numbers.h"

namespace lodestone {
namespace {

constexpr std::size_t triangle_grain = 1 << 16;  // so that the number of a cell within its chunk has 16 bits
constexpr std::size_t vertex_grain = 1 << 18;
constexpr std::size_t cell_grain = 16;
constexpr std::uint32_t unowned = 0x7fff'ffffu;

// Consecutive triangles of one cell.
struct Run {
  std::uint64_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t cell = 0;  // number within the chunk, then among all cells
};

struct Chunk {
  std::vector<CellCode> codes;  // by number
  std::vector<Run> runs;        // by number
  std::uint64_t fingerprint = 0;
};

// One worker's memory for the chunk at hand.
struct ChunkScratch {
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

// The cell of every triangle of the chunk, as a number within the chunk, counted. Returns the sum of the fingerprints.
std::uint64_t number_cells(const IndexedMesh& mesh, ChunkRange range, int level, ChunkScratch& s) {
  s.cells.clear();
  s.next.clear();
  s.number.resize(range.end - range.begin);
  std::uint64_t fingerprint = 0;
  std::uint32_t number = 0;
  // Mostly the cell is that of the triangle before: equal whole parts of the barycentre in units of cells. Same
  // operations as in `barycentre` and `cell_of`, since scaling by a power of two rounds nothing.
  const Float4 per_cell = all4(1.0f / 3.0f * static_cast<float>(1u << level));
  Int4 last{-1, -1, -1, -1};
  const std::size_t last_ahead = mesh.triangles.size() - 1;
  for (std::size_t t = range.begin; t < range.end; ++t) {
    for (const std::uint32_t v : mesh.triangles[std::min(t + prefetch_distance, last_ahead)].v)
      prefetch(&mesh.positions[v]);
    const auto& v = mesh.triangles[t].v;
    const Vec3f &a = mesh.positions[v[0]], &b = mesh.positions[v[1]], &c = mesh.positions[v[2]];
    const Int4 whole = __builtin_convertvector(((to_float4(a) + to_float4(b)) + to_float4(c)) * per_cell, Int4);
    if (!equal(whole, last)) {
      last = whole;
      number = s.cells.number(CellCode::from(cell_of(barycentre(a, b, c), level)));
      if (number == s.next.size()) s.next.push_back(0);
    }
    s.number[t - range.begin] = static_cast<std::uint16_t>(number);
    ++s.next[number];
    fingerprint += triangle_fingerprint(a, b, c);
  }
  return fingerprint;
}

// Copies the triangles of the chunk to runs, in the same range of `sorted`.
void sort_chunk(std::span<const Triangle> triangles, ChunkRange range, ChunkScratch& s, Chunk& chunk,
                std::span<Triangle> sorted) {
  chunk.codes.assign(s.cells.codes.begin(), s.cells.codes.end());
  chunk.runs.resize(chunk.codes.size());
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < chunk.runs.size(); ++i) {
    chunk.runs[i] = {range.begin + first, s.next[i], i};
    first += std::exchange(s.next[i], first);
  }
  Triangle* const to = sorted.data() + range.begin;
  for (std::size_t t = range.begin; t < range.end; ++t) to[s.next[s.number[t - range.begin]]++] = triangles[t];
}

std::vector<Chunk> sort_chunks(const IndexedMesh& mesh, int level, std::span<Triangle> sorted, Scheduler& scheduler) {
  std::vector<Chunk> chunks(chunk_count(mesh.triangles.size(), triangle_grain));
  std::vector<ChunkScratch> scratch(static_cast<std::size_t>(scheduler.workers()));
  scheduler.for_chunks(mesh.triangles.size(), triangle_grain, [&](ChunkRange range) {
    ChunkScratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    Chunk& chunk = chunks[range.index];
    chunk.fingerprint = number_cells(mesh, range, level, s);
    sort_chunk(mesh.triangles, range, s, chunk, sorted);
  });
  return chunks;
}

// The cells of all chunks in Morton order; runs learn the rank of theirs.
std::vector<CellCode> rank_cells(std::vector<Chunk>& chunks) {
  CellNumbers all;
  for (Chunk& chunk : chunks)
    for (Run& run : chunk.runs) run.cell = all.number(chunk.codes[run.cell]);
  std::vector<CellCode> codes = all.codes;
  std::sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> rank(codes.size());
  for (std::uint32_t c = 0; c < codes.size(); ++c) rank[all.number(codes[c])] = c;
  for (Chunk& chunk : chunks)
    for (Run& run : chunk.runs) run.cell = rank[run.cell];
  return codes;
}

RunTable gather_runs(const std::vector<Chunk>& chunks, std::size_t cells) {
  RunTable table;
  table.first_run.assign(cells + 1, 0);
  table.first_triangle.assign(cells + 1, 0);
  for (const Chunk& chunk : chunks)
    for (const Run& run : chunk.runs) {
      ++table.first_run[run.cell + 1];
      table.first_triangle[run.cell + 1] += run.count;
    }
  std::partial_sum(table.first_run.begin(), table.first_run.end(), table.first_run.begin());
  std::partial_sum(table.first_triangle.begin(), table.first_triangle.end(), table.first_triangle.begin());
  table.runs.resize(table.first_run.back());
  std::vector<std::uint64_t> next(table.first_run.begin(), table.first_run.end() - 1);
  for (const Chunk& chunk : chunks)
    for (const Run& run : chunk.runs) table.runs[next[run.cell]++] = run;
  return table;
}

// Remembers the first cell that claims a vertex, flags the vertex when another one does. The flag does not depend on
// who came first; the owner is forgotten afterwards.
void claim_vertex(std::uint32_t& owner, std::uint32_t rank) {
  const std::atomic_ref word(owner);
  std::uint32_t old = word.load(std::memory_order_relaxed);
  while (old != rank && !(old & FinestVertices::shared_flag)) {
    const std::uint32_t claimed = old == unowned ? rank : FinestVertices::shared_flag;
    if (word.compare_exchange_weak(old, claimed, std::memory_order_relaxed)) return;
  }
}

// Moves the runs of the cells together, with local ids, and claims the vertices.
void fill_cells(const RunTable& table, std::span<const Triangle> sorted, Partition& out, Scheduler& scheduler) {
  const bool wedges = out.vertices.attributes.wedges;
  std::vector<VertexNumbers> scratch(static_cast<std::size_t>(scheduler.workers()));
  scheduler.for_chunks(out.cells.size(), cell_grain, [&](ChunkRange range) {
    VertexNumbers& numbers = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t c = range.begin; c < range.end; ++c) {
      const std::uint64_t first = table.first_triangle[c], count = table.first_triangle[c + 1] - first;
      CellBuild& cell = out.cells[c];
      cell.triangles = std::span(out.triangles).subspan(first, count);
      Triangle* to = cell.triangles.data();
      numbers.clear(count);
      for (std::uint64_t r = table.first_run[c]; r < table.first_run[c + 1]; ++r) {
        numbers.number(sorted.subspan(table.runs[r].first, table.runs[r].count), to);
        to += table.runs[r].count;
      }
      cell.ids.assign(numbers.vertices().begin(), numbers.vertices().end());
      for (std::size_t i = 0; i < cell.ids.size(); ++i) {
        prefetch(&out.vertices.sharing[cell.ids[std::min(i + prefetch_distance, cell.ids.size() - 1)]]);
        const std::uint32_t vertex = wedges ? out.vertices.wedges.vertex[cell.ids[i]] : cell.ids[i];
        claim_vertex(out.vertices.sharing[vertex], static_cast<std::uint32_t>(c));
      }
    }
  });
}

// Replaces the owners of shared vertices by consecutive indices in vertex order; returns their number.
std::size_t number_shared(std::span<std::uint32_t> sharing, Scheduler& scheduler) {
  std::vector<std::size_t> first(chunk_count(sharing.size(), vertex_grain) + 1, 0);
  scheduler.for_chunks(sharing.size(), vertex_grain, [&](ChunkRange range) {
    for (std::size_t v = range.begin; v < range.end; ++v) first[range.index + 1] += sharing[v] >> 31;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  scheduler.for_chunks(sharing.size(), vertex_grain, [&](ChunkRange range) {
    auto next = static_cast<std::uint32_t>(first[range.index]);
    for (std::size_t v = range.begin; v < range.end; ++v)
      if (sharing[v] & FinestVertices::shared_flag) sharing[v] = FinestVertices::shared_flag | next++;
  });
  return first.back();
}

// From the vertices to all their wedges.
void spread_numbers(FinestVertices& vertices, Scheduler& scheduler) {
  const std::vector<std::uint32_t>& vertex = vertices.wedges.vertex;
  scheduler.for_chunks(vertex.size(), vertex_grain, [&](ChunkRange range) {
    for (std::size_t w = range.begin; w < range.end; ++w)
      if (vertex[w] != w) vertices.sharing[w] = vertices.sharing[vertex[w]];
  });
}

}  // namespace

AttributeSet attributes_of(const IndexedMesh& mesh) {
  const WedgeAttributes& w = mesh.wedges;
  return {!w.vertex.empty(), !w.uv.empty(), !w.colour.empty(), !w.material.empty()};
}

Partition partition_mesh(IndexedMesh&& mesh, int level, Scheduler& scheduler) {
  Partition out;
  // As bytes: a Triangle would be set to zero first.
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(mesh.triangles.size() * sizeof(Triangle));
  const std::span sorted(reinterpret_cast<Triangle*>(memory.get()), mesh.triangles.size());
  RunTable table;
  {
    std::vector<Chunk> chunks = sort_chunks(mesh, level, sorted, scheduler);
    for (const Chunk& chunk : chunks) out.fingerprint += chunk.fingerprint;
    out.codes = rank_cells(chunks);
    table = gather_runs(chunks, out.codes.size());
  }
  out.triangles = std::move(mesh.triangles);  // to be overwritten
  out.vertices.positions = std::move(mesh.positions);
  out.vertices.attributes = attributes_of(mesh);
  out.vertices.wedges = std::move(mesh.wedges);
  out.vertices.sharing.assign(out.vertices.positions.size(), unowned);
  out.cells.resize(out.codes.size());
  fill_cells(table, sorted, out, scheduler);
  out.vertices.shared = number_shared(out.vertices.sharing, scheduler);
  if (out.vertices.attributes.wedges) spread_numbers(out.vertices, scheduler);
  return out;
}

int choose_finest_level(const IndexedMesh& mesh, std::uint32_t cell_triangles) {
  constexpr std::size_t sample_size = 1 << 16;
  const std::size_t stride = std::max<std::size_t>(1, mesh.triangles.size() / sample_size);
  std::vector<CellCode> sample;  // on the finest level of all; those of other levels are the first bits
  const auto ahead = [&](std::size_t t, std::size_t strides) -> const Triangle& {
    return mesh.triangles[std::min(t + strides * stride, mesh.triangles.size() - 1)];
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); t += stride) {
    prefetch(&ahead(t, 2 * prefetch_distance));
    for (const std::uint32_t v : ahead(t, prefetch_distance).v) prefetch(&mesh.positions[v]);
    const auto& v = mesh.triangles[t].v;
    const Vec3f centre = barycentre(mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]);
    sample.push_back(CellCode::from(cell_of(centre, max_level)));
  }
  int best = 0;
  double best_misfit = std::numeric_limits<double>::infinity();
  CellNumbers occupied;
  for (int level = 0; level <= max_level; ++level) {
    occupied.clear();
    CellCode last{~0ull};
    for (const CellCode finest : sample) {
      const CellCode code{finest.morton >> (3 * (max_level - level))};
      if (code != last) (void)occupied.number(last = code);
    }
    const double mean = static_cast<double>(mesh.triangles.size()) / static_cast<double>(occupied.codes.size());
    const double misfit = std::abs(std::log(mean / cell_triangles));
    if (misfit < best_misfit) best = level, best_misfit = misfit;
    if (mean < cell_triangles) break;
  }
  return best;
}

}  // namespace lodestone
