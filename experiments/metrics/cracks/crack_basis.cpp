#include "experiments/metrics/cracks/crack_basis.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/base/error.h"
#include "experiments/metrics/cracks/cracks.h"

namespace lodestone {
namespace {

constexpr std::size_t basis_cells_per_chunk = 16;

// Boundaries of single cells; keeps its working memory from cell to cell.
class BoundaryFinder {
 public:
  // Appends the boundary of the cell's triangles, by its lower local id and then by the higher one.
  void append_boundary(const Cell& cell, std::vector<LocalEdge>& out) {
    bucket_by_lower_end(cell);
    for (std::uint32_t lower = 0; lower + 1 < begin_.size(); ++lower) append_net(lower, out);
  }

 private:
  // Half-edges as (higher end, direction), grouped by their lower end: a counting sort.
  void bucket_by_lower_end(const Cell& cell) {
    begin_.assign(cell.positions.size() + 1, 0);
    for_half_edges(cell, [&](std::uint32_t from, std::uint32_t to) { ++begin_[std::min(from, to) + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    next_.assign(begin_.begin(), begin_.end());
    ends_.resize(begin_.back());
    for_half_edges(cell, [&](std::uint32_t from, std::uint32_t to) {
      const std::uint64_t reversed = from > to;
      ends_[next_[std::min(from, to)]++] = std::uint64_t{std::max(from, to)} << 1 | reversed;
    });
  }

  template <typename Body>
  static void for_half_edges(const Cell& cell, const Body& body) {
    for (const Triangle& t : cell.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = t.v[k], to = t.v[(k + 1) % 3];
        if (from != to) body(from, to);
      }
  }

  void append_net(std::uint32_t lower, std::vector<LocalEdge>& out) {
    const auto first = ends_.begin() + begin_[lower], last = ends_.begin() + begin_[lower + 1];
    std::sort(first, last);
    for (auto run = first; run != last;) {
      const auto higher = static_cast<std::uint32_t>(*run >> 1);
      std::int64_t net = 0;
      for (; run != last && *run >> 1 == higher; ++run) net += (*run & 1) ? -1 : 1;
      for (; net > 0; --net) out.push_back({VertexId(lower), VertexId(higher)});
      for (; net < 0; ++net) out.push_back({VertexId(higher), VertexId(lower)});
    }
  }

  std::vector<std::uint32_t> begin_, next_;
  std::vector<std::uint64_t> ends_;
};

void find_leaves(const Hierarchy& hierarchy, CrackBasis& basis) {
  basis.leaves.resize(hierarchy.cells.size());
  const Level& finest = hierarchy.levels.back();
  for (CellRank i{0}; i < finest.cell_count; ++i) basis.leaves[finest.id_of(i)] = {i, CellRank(i + 1)};
  for (int l = hierarchy.finest() - 1; l >= 0; --l) {
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    for (CellId i = level.first_cell; i < level.end_cell(); ++i) {
      const Cell& cell = hierarchy.cells[i];
      if (cell.child_count == 0) continue;
      basis.leaves[i] = {basis.leaves[cell.first_child].begin, basis.leaves[cell.end_child() - 1].end};
    }
  }
}

void find_boundaries(const Hierarchy& hierarchy, Scheduler& scheduler, CrackBasis& basis) {
  const std::size_t cells = hierarchy.cells.size();
  std::vector<std::vector<LocalEdge>> parts(chunk_count(cells, basis_cells_per_chunk));
  std::vector<BoundaryFinder> finders(static_cast<std::size_t>(scheduler.workers()));
  basis.boundary_begin.assign(cells + 1, 0);
  scheduler.for_chunks(cells, basis_cells_per_chunk, [&](ChunkRange chunk) {
    BoundaryFinder& finder = finders[static_cast<std::size_t>(scheduler.worker_index())];
    std::vector<LocalEdge>& part = parts[chunk.index];
    for (std::size_t c = chunk.begin; c < chunk.end; ++c) {
      const std::size_t before = part.size();
      finder.append_boundary(hierarchy.cells[c], part);
      basis.boundary_begin[c + 1] = part.size() - before;
    }
  });
  for (std::size_t c = 0; c < cells; ++c) basis.boundary_begin[c + 1] += basis.boundary_begin[c];
  basis.boundary.reserve(basis.boundary_begin.back());
  for (std::vector<LocalEdge>& part : parts) {
    basis.boundary.insert(basis.boundary.end(), part.begin(), part.end());
    part = {};
  }
}

// A half-edge of M_L that its leaf leaves unpaired, by the identity of its ends.
struct Candidate {
  std::uint64_t ends = 0;   // lower shared id, higher shared id
  std::uint64_t index = 0;  // among the boundary edges of all leaves, so by leaf
  bool reversed = false;    // runs from the higher to the lower id
};

// Marks the members of one edge's group that have no partner: as many as the directions differ by, the last ones.
void mark_unpaired(std::span<const Candidate> group, std::vector<std::uint8_t>& unpaired) {
  std::int64_t net = 0;
  for (const Candidate& c : group) net += c.reversed ? -1 : 1;
  const bool reversed = net < 0;
  for (std::size_t left = static_cast<std::size_t>(std::abs(net)), i = group.size(); left > 0; --i) {
    if (group[i - 1].reversed != reversed) continue;
    unpaired[group[i - 1].index] = 1;
    --left;
  }
}

void find_unpaired(const Hierarchy& hierarchy, CrackBasis& basis) {
  const Level& finest = hierarchy.levels.back();
  const std::uint64_t first = basis.boundary_begin[finest.first_cell];
  std::vector<std::uint8_t> unpaired(basis.boundary_begin.back() - first, 0);
  std::vector<Candidate> candidates;
  for (CellId leaf = finest.first_cell; leaf < finest.end_cell(); ++leaf) {
    const Cell& cell = hierarchy.cells[leaf];
    std::uint64_t index = basis.boundary_begin[leaf] - first;
    for (const LocalEdge& edge : basis.boundary_of(leaf)) {
      if (std::min(edge.from, edge.to) < cell.first_shared()) {
        unpaired[index] = 1;  // no other leaf uses both ends
      } else {
        const std::uint64_t from = cell.shared_ids[edge.from - cell.first_shared()];
        const std::uint64_t to = cell.shared_ids[edge.to - cell.first_shared()];
        candidates.push_back({std::min(from, to) << 32 | std::max(from, to), index, from > to});
      }
      ++index;
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.ends, a.index) < std::tie(b.ends, b.index);
  });
  for (std::size_t begin = 0, end = 0; begin < candidates.size(); begin = end) {
    while (end < candidates.size() && candidates[end].ends == candidates[begin].ends) ++end;
    mark_unpaired(std::span(candidates).subspan(begin, end - begin), unpaired);
  }

  basis.unpaired_begin.assign(1, 0);
  for (CellId leaf = finest.first_cell; leaf < finest.end_cell(); ++leaf) {
    for (std::uint64_t e = basis.boundary_begin[leaf]; e < basis.boundary_begin[leaf + 1]; ++e)
      if (unpaired[e - first]) basis.unpaired.push_back(basis.boundary[e]);
    basis.unpaired_begin.push_back(basis.unpaired.size());
  }
}

void find_copies(const Hierarchy& hierarchy, CrackBasis& basis) {
  std::vector<std::uint64_t> copies;  // shared id, number of the copy
  basis.copy_begin.assign(1, 0);
  for (const Cell& leaf : hierarchy.cells_of(hierarchy.finest())) {
    if (copies.size() + leaf.shared_ids.size() > std::numeric_limits<std::uint32_t>::max())
      throw ResourceError("the finest level has more than 2^32 copies of shared vertices; use larger cells");
    for (const std::uint32_t id : leaf.shared_ids) copies.push_back(std::uint64_t{id} << 32 | copies.size());
    basis.copy_begin.push_back(static_cast<std::uint32_t>(copies.size()));
  }
  std::sort(copies.begin(), copies.end());
  basis.copies.reserve(copies.size());
  for (std::size_t i = 0; i < copies.size(); ++i) {
    if (i == 0 || copies[i] >> 32 != copies[i - 1] >> 32) basis.vertex_begin.push_back(static_cast<std::uint32_t>(i));
    basis.copies.push_back(static_cast<std::uint32_t>(copies[i]));
  }
  basis.vertex_begin.push_back(static_cast<std::uint32_t>(copies.size()));
}

}  // namespace

std::shared_ptr<const CrackBasis> make_crack_basis(const Hierarchy& hierarchy, Scheduler& scheduler) {
  const auto made = std::make_shared<CrackBasis>();
  CrackBasis& basis = *made;
  find_leaves(hierarchy, basis);
  find_boundaries(hierarchy, scheduler, basis);
  find_unpaired(hierarchy, basis);
  find_copies(hierarchy, basis);
  return made;
}

}  // namespace lodestone
