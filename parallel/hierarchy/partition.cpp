// A counting sort in two steps: triangles of a chunk to runs of one cell each (parallel/hierarchy/cell_runs.h); then
// the runs of a cell, in the order of chunks, to the cell. The second step gives the vertices their local ids.
//
// This keeps the input order within a cell for any number of workers. What several workers add to one place is added
// with operations that commute exactly.
#include "parallel/hierarchy/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "core/base/prefetch.h"
#include "parallel/hierarchy/cell_runs.h"
#include "parallel/hierarchy/vertex_stamps.h"
#include "parallel/mesh/vertex_sharing.h"

namespace lodestone {
namespace {

constexpr std::size_t vertex_grain = 1 << 18;
constexpr std::size_t cell_grain = 16;

class MemorySource final : public TriangleSource {
 public:
  explicit MemorySource(std::span<const Triangle> sorted) : sorted_(sorted) {}
  [[nodiscard]] std::span<const Triangle> read(const Run& run, std::span<Triangle> /*room*/) const override {
    return sorted_.subspan(run.first, run.count);
  }

 private:
  std::span<const Triangle> sorted_;
};

// Moves the runs of a cell together, with local ids, and claims its vertices.
void fill_cell(const CellRuns& runs, CellRank rank, const TriangleSource& source, Partition& out,
               VertexNumbers& numbers) {
  CellBuild& cell = out.cells[rank];
  collect_cell(runs, rank, source, cell.triangles, numbers, cell);
  const bool wedges = out.vertices.attributes.wedges;
  for (std::size_t i = 0; i < cell.ids.size(); ++i) {
    prefetch(&out.vertices.sharing[cell.ids[std::min(i + prefetch_distance, cell.ids.size() - 1)]]);
    const std::uint32_t vertex = wedges ? out.vertices.wedges.vertex[cell.ids[i]] : cell.ids[i];
    claim_vertex(out.vertices.sharing[vertex], rank);
  }
}

// The same for all cells, by stamps where they can be had.
void fill_cells(const CellRuns& runs, const TriangleSource& source, Partition& out, Scheduler& scheduler) {
  const bool stamped = !out.vertices.attributes.wedges;
  VertexStamps stamps(stamped ? std::span(out.vertices.sharing) : std::span<std::uint32_t>(), scheduler.workers() == 1);
  std::vector<VertexStamps::Scratch> scratch(static_cast<std::size_t>(scheduler.workers()));
  scheduler.for_chunks(out.cells.size(), cell_grain, [&](ChunkRange range) {
    VertexStamps::Scratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (CellRank c(range.begin); c < range.end; ++c) {
      CellBuild& cell = out.cells[c];
      cell.triangles = std::span(out.triangles).subspan(runs.first_triangle[c], runs.triangles_of(c));
      if (stamped && cell.triangles.size() <= VertexStamps::most_triangles)
        stamps.collect_cell(runs, c, source, s, cell);
      else
        fill_cell(runs, c, source, out, s.numbers);
    }
  });
}

}  // namespace

AttributeSet attributes_of(const IndexedMesh& mesh) {
  const WedgeAttributes& w = mesh.wedges;
  return {
      .wedges = !w.vertex.empty(), .uv = !w.uv.empty(), .colours = !w.colour.empty(), .materials = !w.material.empty()};
}

void number_shared_vertices(FinestVertices& vertices, Scheduler& scheduler) {
  const std::vector<std::uint32_t>& vertex = vertices.wedges.vertex;
  const auto for_others = [&](const auto& value) {  // wedges that are not the first of their vertex
    scheduler.for_chunks(vertex.size(), vertex_grain, [&](ChunkRange range) {
      for (std::size_t w = range.begin; w < range.end; ++w)
        if (vertex[w] != w) vertices.sharing[w] = value(w);
    });
  };
  for_others([](std::size_t) { return unowned; });
  vertices.shared = number_shared(vertices.sharing, scheduler);
  for_others([&](std::size_t w) { return vertices.sharing[vertex[w]]; });
}

Partition partition_mesh(IndexedMesh&& mesh, int level, Scheduler& scheduler) {
  Partition out;
  // As bytes: a Triangle would be set to zero first.
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(mesh.triangles.size() * sizeof(Triangle));
  const std::span sorted(reinterpret_cast<Triangle*>(memory.get()), mesh.triangles.size());
  const CellRuns runs = RunSorter(mesh.positions, level, scheduler)
                            .sort(
                                mesh.triangles.size(),
                                [&](ChunkRange range, std::vector<Triangle>& /*room*/) {
                                  return std::span(mesh.triangles).subspan(range.begin, range.end - range.begin);
                                },
                                sorted);
  out.codes = runs.codes;
  out.fingerprint = runs.fingerprint;
  out.triangles = std::move(mesh.triangles);  // to be overwritten
  out.vertices.positions = std::move(mesh.positions);
  out.vertices.attributes = attributes_of(mesh);
  out.vertices.wedges = std::move(mesh.wedges);
  out.vertices.sharing.assign(out.vertices.positions.size(), unowned);
  out.cells.resize(out.codes.size());
  fill_cells(runs, MemorySource(sorted), out, scheduler);
  number_shared_vertices(out.vertices, scheduler);
  return out;
}

int choose_finest_level(const IndexedMesh& mesh, std::uint32_t cell_triangles) {
  const std::size_t stride = level_sample_stride(mesh.triangles.size());
  std::vector<CellCode> sample;
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
  return finest_level_of(sample, mesh.triangles.size(), cell_triangles);
}

std::size_t level_sample_stride(std::size_t triangles) {
  constexpr std::size_t sample_size = 1 << 16;
  return std::max<std::size_t>(1, triangles / sample_size);
}

int finest_level_of(std::span<const CellCode> sample, std::size_t triangles, std::uint32_t cell_triangles) {
  CellNumbers cells;
  const auto occupied = [&](int level) {
    cells.clear(cells.size());
    CellCode last{~0ull};
    for (const CellCode finest : sample) {
      const CellCode code{finest.morton >> (3 * (max_level - level))};
      if (code != last) (void)cells.number(last = code);
    }
    return cells.size();
  };
  return finest_level_of(occupied, sample.size(), triangles, cell_triangles);
}

int finest_level_of(const std::function<std::size_t(int level)>& occupied, std::size_t sampled, std::size_t triangles,
                    std::uint32_t cell_triangles) {
  // With fewer samples for a cell many cells are not seen: their number grows from level to level as it did before.
  const double fewest = sampled < triangles ? 4 : 0;
  int best = 0;
  double best_misfit = std::numeric_limits<double>::infinity(), cells = 1, growth = 1;
  for (int level = 0; level <= max_level; ++level) {
    const auto seen = static_cast<double>(occupied(level));
    const bool sees_all = seen * fewest <= static_cast<double>(sampled);
    if (sees_all) growth = seen / cells;
    cells = sees_all ? seen : std::max(seen, cells * growth);
    const double mean = static_cast<double>(triangles) / cells;
    const double misfit = std::abs(std::log(mean / cell_triangles));
    if (misfit < best_misfit) best = level, best_misfit = misfit;
    if (mean < cell_triangles) break;
  }
  return best;
}

}  // namespace lodestone
