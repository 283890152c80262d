#include "experiments/metrics/cracks/cracks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "experiments/metrics/cracks/crack_basis.h"
#include "experiments/metrics/drawn/screen.h"

namespace lodestone {
namespace {

using DrawnEdge = CrackScratch::DrawnEdge;
using HashedEdge = CrackScratch::HashedEdge;
using Place = CrackScratch::Place;

constexpr std::size_t cells_per_chunk = 4;
constexpr std::size_t vertices_per_chunk = 4096;
constexpr std::size_t max_samples = 8;
// Edges are netted bucket by bucket, by the leading bits of their hash; a bucket is one task.
constexpr int bucket_bits = 5;
constexpr std::size_t buckets = std::size_t{1} << bucket_bits;

// ---- what both forms share ----

// Leaves that are not below exactly one selected cell.
std::uint64_t count_uncovered(const Selection& selection, const CrackBasis& basis, std::size_t leaf_count,
                              std::vector<std::uint8_t>& covered) {
  covered.assign(leaf_count, 0);
  for (const SelectedCell& selected : selection.cells) {
    const LeafRange leaves = basis.leaves[selected.cell];
    for (CellRank leaf = leaves.begin; leaf < leaves.end; ++leaf)
      covered[leaf] = static_cast<std::uint8_t>(std::min(covered[leaf] + 1, 2));
  }
  return leaf_count - static_cast<std::uint64_t>(std::count(covered.begin(), covered.end(), std::uint8_t{1}));
}

// Calls body(selected cell, its number in the selection, its drawn positions) for each selected cell, in parallel.
template <typename Body>
void for_drawn_cells(const MorphContext& context, const Selection& selection, Scheduler& scheduler,
                     CrackScratch& scratch, const Body& body) {
  scratch.morphed.resize(static_cast<std::size_t>(scheduler.workers()));
  scheduler.for_chunks(selection.cells.size(), cells_per_chunk, [&](ChunkRange chunk) {
    std::vector<Vec3f>& morphed = scratch.morphed[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
      const SelectedCell& selected = selection.cells[i];
      morphed.resize(context.hierarchy->cells[selected.cell].positions.size());
      morph_cell(context, selected.cell, morphed);
      body(selected, i, std::span<const Vec3f>(morphed));
    }
  });
}

// ---- chain form ----

using PositionBits = std::array<std::uint32_t, 3>;

// Equal exactly where the positions weld: -0 + 0 is +0, everything else keeps its bits.
PositionBits bits_of(Vec3f p) {
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v + 0.0f); };
  return {bits(p.x), bits(p.y), bits(p.z)};
}

// An edge and its reverse are one edge with opposite signs: the lower end first, by bits.
DrawnEdge oriented(Vec3f from, Vec3f to, std::int32_t sign, CellId cell) {
  const PositionBits a = bits_of(from), b = bits_of(to);
  if (a == b) return {from, to, 0, cell};
  return a < b ? DrawnEdge{from, to, sign, cell} : DrawnEdge{to, from, -sign, cell};
}

std::uint64_t hash_of(const DrawnEdge& edge) {
  std::uint64_t hash = 0;
  const auto add = [&](std::uint64_t value) {
    hash = (hash ^ value) * 0x9e37'79b9'7f4a'7c15ull;  // 2^64 over the golden ratio
    hash ^= hash >> 29;
  };
  const PositionBits a = bits_of(edge.from), b = bits_of(edge.to);
  add(a[0] | std::uint64_t{a[1]} << 32);
  add(a[2] | std::uint64_t{b[0]} << 32);
  add(b[1] | std::uint64_t{b[2]} << 32);
  return hash * 0xd6e8'feb8'6659'fd93ull;
}

// Places of each selected cell's edges: its own boundary, then the expected one.
void lay_out_edges(const Selection& selection, const CrackBasis& basis, CrackScratch& scratch) {
  scratch.edges_begin.clear();
  std::size_t count = 0;
  for (const SelectedCell& selected : selection.cells) {
    scratch.edges_begin.push_back(count);
    const LeafRange leaves = basis.leaves[selected.cell];
    count += basis.boundary_of(selected.cell).size();
    count += basis.unpaired_begin[leaves.end] - basis.unpaired_begin[leaves.begin];
  }
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError("the drawn cells have more than 2^32 border edges; measure a coarser view");
  scratch.edges.resize(count);
  scratch.hashes.resize(count);
}

void draw_edges(const MorphContext& context, const Selection& selection, const CrackBasis& basis, Scheduler& scheduler,
                CrackScratch& scratch) {
  const Hierarchy& hierarchy = *context.hierarchy;
  const Level& finest = hierarchy.levels.back();
  for_drawn_cells(
      context, selection, scheduler, scratch,
      [&](const SelectedCell& selected, std::size_t i, std::span<const Vec3f> drawn) {
        std::size_t next = scratch.edges_begin[i];
        const auto put = [&](Vec3f from, Vec3f to, std::int32_t sign) {
          scratch.edges[next] = oriented(from, to, sign, selected.cell);
          scratch.hashes[next] = hash_of(scratch.edges[next]);
          ++next;
        };
        for (const LocalEdge& edge : basis.boundary_of(selected.cell)) put(drawn[edge.from], drawn[edge.to], 1);
        const LeafRange leaves = basis.leaves[selected.cell];
        for (CellRank leaf = leaves.begin; leaf < leaves.end; ++leaf) {
          const auto followed = [&](VertexId vertex) {
            return drawn[follow_parents(hierarchy, finest.id_of(leaf), vertex, hierarchy.finest(), selected.level)];
          };
          for (const LocalEdge& edge : basis.unpaired_of(leaf)) put(followed(edge.from), followed(edge.to), -1);
        }
      });
}

// Adds up the edges of one bucket. Equal edges have equal hashes; positions decide between equal hashes.
CrackReport net_bucket(std::size_t bucket, const CrackScratch& scratch, std::vector<HashedEdge>& hashed) {
  hashed.clear();
  for (std::size_t i = 0; i < scratch.hashes.size(); ++i)
    if (scratch.hashes[i] >> (64 - bucket_bits) == bucket && scratch.edges[i].sign != 0)
      hashed.push_back({scratch.hashes[i], static_cast<std::uint32_t>(i)});

  const auto edge = [&](const HashedEdge& h) -> const DrawnEdge& { return scratch.edges[h.edge]; };
  const auto same = [&](const HashedEdge& a, const HashedEdge& b) {
    return a.hash == b.hash && bits_of(edge(a).from) == bits_of(edge(b).from) &&
           bits_of(edge(a).to) == bits_of(edge(b).to);
  };
  std::sort(hashed.begin(), hashed.end(), [&](const HashedEdge& a, const HashedEdge& b) {
    if (a.hash != b.hash) return a.hash < b.hash;
    if (!same(a, b)) {
      const auto key = [&](const HashedEdge& h) { return std::array{bits_of(edge(h).from), bits_of(edge(h).to)}; };
      return key(a) < key(b);
    }
    return a.edge < b.edge;
  });

  CrackReport report;
  for (std::size_t begin = 0, end = 0; begin < hashed.size(); begin = end) {
    std::int64_t net = 0;
    while (end < hashed.size() && same(hashed[begin], hashed[end])) net += edge(hashed[end++]).sign;
    if (net == 0) continue;
    report.open_edges += static_cast<std::uint64_t>(std::abs(net));
    const DrawnEdge& first = edge(hashed[begin]);
    if (report.samples.size() < max_samples) report.samples.push_back({first.from, first.to, net, first.cell});
  }
  return report;
}

// ---- map form ----

// The drawn surface is the image of M_L under the map (vertex, leaf that uses it) -> the place where the drawn cell
// above the leaf puts the vertex's image; it is one map of the vertices of M_L iff the leaves that use a vertex agree
// on it. A vertex that one leaf alone uses agrees with itself, so the shared vertices of level L are all that need
// looking at: whatever two drawn cells have in common at a coarser level is the image of one of them.
void draw_copies(const MorphContext& context, const Selection& selection, const CrackBasis& basis, Scheduler& scheduler,
                 CrackScratch& scratch) {
  const Hierarchy& hierarchy = *context.hierarchy;
  const Level& finest = hierarchy.levels.back();
  scratch.copies.resize(basis.copies.size());
  for_drawn_cells(context, selection, scheduler, scratch,
                  [&](const SelectedCell& selected, std::size_t, std::span<const Vec3f> drawn) {
                    const LeafRange leaves = basis.leaves[selected.cell];
                    for (CellRank leaf = leaves.begin; leaf < leaves.end; ++leaf) {
                      if (scratch.covered[leaf] != 1) continue;
                      const std::uint32_t first_shared = hierarchy.cells[finest.id_of(leaf)].first_shared();
                      const std::uint32_t copies = basis.copy_begin[leaf + 1] - basis.copy_begin[leaf];
                      for (std::uint32_t k = 0; k < copies; ++k)
                        scratch.copies[basis.copy_begin[leaf] + k] =
                            drawn[follow_parents(hierarchy, finest.id_of(leaf), VertexId(first_shared + k),
                                                 hierarchy.finest(), selected.level)];
                    }
                  });
}

struct GapSum {
  double max = 0, sum = 0, max_pixels = 0, sum_pixels = 0;
  std::uint64_t gaps = 0, in_view = 0;
  Vec3f where;

  void add(const Place& a, const Place& b, const Screen* screen) {
    const double gap = length(to_double(a.position) - to_double(b.position));
    const std::uint64_t pairs = a.copies * b.copies;
    gaps += pairs;
    sum += gap * static_cast<double>(pairs);
    if (gap > max) {
      max = gap;
      where = a.position;
    }
    if (screen) add_seen(a, b, *screen);
  }

 private:
  void add_seen(const Place& a, const Place& b, const Screen& screen) {
    const auto from = screen.project(to_double(a.position)), to = screen.project(to_double(b.position));
    if (!from || !to || !(from->inside || to->inside)) return;
    const std::uint64_t pairs = a.copies * b.copies;
    const double gap = distance(*from, *to);
    in_view += pairs;
    sum_pixels += gap * static_cast<double>(pairs);
    max_pixels = std::max(max_pixels, gap);
  }
};

// The different places of one vertex, each with the number of its copies there: few, however many leaves use it.
void collect_places(std::span<const std::uint32_t> copies, std::span<const Vec3f> drawn,
                    const std::vector<std::uint8_t>& draws_copy, std::vector<Place>& places) {
  places.clear();
  for (const std::uint32_t copy : copies) {
    if (!draws_copy.empty() && !draws_copy[copy]) continue;
    const auto known =
        std::find_if(places.begin(), places.end(), [&](const Place& place) { return place.position == drawn[copy]; });
    if (known == places.end()) {
      places.push_back({drawn[copy], 1});
    } else {
      ++known->copies;
    }
  }
}

// One flag per copy: is its leaf covered once? Empty for a partition.
std::vector<std::uint8_t> covered_copies(const CrackBasis& basis, std::uint64_t uncovered,
                                         const std::vector<std::uint8_t>& covered) {
  std::vector<std::uint8_t> flags;
  if (uncovered == 0) return flags;
  for (std::size_t leaf = 0; leaf < covered.size(); ++leaf)
    flags.insert(flags.end(), basis.copy_begin[leaf + 1] - basis.copy_begin[leaf], covered[leaf] == 1 ? 1 : 0);
  return flags;
}

}  // namespace

CrackReport residual_edges(const MorphContext& context, const Selection& selection, const CrackBasis& basis,
                           Scheduler& scheduler, CrackScratch& scratch) {
  assert(basis.leaves.size() == context.hierarchy->cells.size());
  lay_out_edges(selection, basis, scratch);
  draw_edges(context, selection, basis, scheduler, scratch);

  scratch.hashed.resize(static_cast<std::size_t>(scheduler.workers()));
  std::array<CrackReport, buckets> parts;
  scheduler.for_chunks(buckets, 1, [&](ChunkRange bucket) {
    auto& hashed = scratch.hashed[static_cast<std::size_t>(scheduler.worker_index())];
    parts[bucket.index] = net_bucket(bucket.index, scratch, hashed);
  });

  CrackReport report;
  report.uncovered_leaves =
      count_uncovered(selection, basis, context.hierarchy->levels.back().cell_count, scratch.covered);
  for (const CrackReport& part : parts) {
    report.open_edges += part.open_edges;
    for (const ResidualEdge& sample : part.samples)
      if (report.samples.size() < max_samples) report.samples.push_back(sample);
  }
  return report;
}

GapReport vertex_gaps(const MorphContext& context, const Selection& selection, const CrackBasis& basis,
                      Scheduler& scheduler, CrackScratch& scratch, const Screen* screen) {
  assert(basis.leaves.size() == context.hierarchy->cells.size());
  GapReport report;
  report.uncovered_leaves =
      count_uncovered(selection, basis, context.hierarchy->levels.back().cell_count, scratch.covered);
  draw_copies(context, selection, basis, scheduler, scratch);

  const std::vector<std::uint8_t> draws_copy = covered_copies(basis, report.uncovered_leaves, scratch.covered);
  const std::size_t vertices = basis.vertex_begin.size() - 1;
  std::vector<GapSum> parts(chunk_count(vertices, vertices_per_chunk));
  scratch.places.resize(static_cast<std::size_t>(scheduler.workers()));
  scheduler.for_chunks(vertices, vertices_per_chunk, [&](ChunkRange chunk) {
    std::vector<Place>& places = scratch.places[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t v = chunk.begin; v < chunk.end; ++v) {
      const std::uint32_t begin = basis.vertex_begin[v], end = basis.vertex_begin[v + 1];
      collect_places(std::span(basis.copies).subspan(begin, end - begin), scratch.copies, draws_copy, places);
      for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t j = i + 1; j < places.size(); ++j) parts[chunk.index].add(places[i], places[j], screen);
    }
  });

  double sum = 0, sum_pixels = 0;
  for (const GapSum& part : parts) {
    sum += part.sum;
    report.gaps += part.gaps;
    sum_pixels += part.sum_pixels;
    report.gaps_in_view += part.in_view;
    report.gap_max_pixels = std::max(report.gap_max_pixels, part.max_pixels);
    if (part.max <= report.gap_max) continue;
    report.gap_max = part.max;
    report.where = part.where;
  }
  report.gap_mean = report.gaps == 0 ? 0 : sum / static_cast<double>(report.gaps);
  if (report.gaps_in_view > 0) report.gap_mean_pixels = sum_pixels / static_cast<double>(report.gaps_in_view);
  return report;
}

}  // namespace lodestone
