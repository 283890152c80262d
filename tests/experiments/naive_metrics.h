// The slow, obvious twins of the metrics: maps over everything, each vertex followed by itself, no basis.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/pops/pops.h"

namespace lodestone::testing {

// Identity of a vertex of one level: its shared id, or its cell and index where it has none.
using Identity = std::array<std::uint32_t, 3>;

inline Identity identity(const Hierarchy& hierarchy, CellId cell, VertexId vertex) {
  const Cell& c = hierarchy.cells[cell];
  if (vertex >= c.first_shared()) return {1, c.shared_ids[vertex - c.first_shared()], 0};
  return {0, cell, vertex};
}

inline CellId first_leaf(const Hierarchy& hierarchy) { return hierarchy.levels.back().first_cell; }

inline std::set<CellId> drawn_cells(const Selection& selection) {
  std::set<CellId> cells;
  for (const SelectedCell& s : selection.cells) cells.insert(s.cell);
  return cells;
}

// The position at which a frame draws a vertex of a leaf: up through the parents to the drawn cell, then the morph.
struct DrawnVertex {
  Vec3f position;
  int level = 0;
};

inline DrawnVertex draw_vertex(const MorphContext& context, const std::set<CellId>& drawn, CellId cell,
                               VertexId vertex) {
  const Hierarchy& h = *context.hierarchy;
  while (!drawn.contains(cell)) {
    vertex = VertexId(h.cells[cell].parents[vertex]);
    cell = h.cells[cell].parent;
  }
  const int level = h.level_of(cell);
  const Vec3f w = h.cells[cell].positions[vertex];
  if (level == 0) return {w, 0};
  return {morph_position(context, level, w, h.cells[h.cells[cell].parent].positions[h.cells[cell].parents[vertex]]),
          level};
}

using Point = std::tuple<float, float, float>;  // compares -0 equal to +0
inline Point point(Vec3f p) { return {p.x, p.y, p.z}; }

class NaiveChain {
 public:
  void add(Vec3f from, Vec3f to, int sign) {
    const Point a = point(from), b = point(to);
    if (a == b) return;
    if (a < b) {
      edges_[{a, b}] += sign;
    } else {
      edges_[{b, a}] -= sign;
    }
  }
  [[nodiscard]] std::uint64_t residual() const {
    std::uint64_t sum = 0;
    for (const auto& [edge, net] : edges_) sum += static_cast<std::uint64_t>(std::abs(net));
    return sum;
  }

 private:
  std::map<std::pair<Point, Point>, int> edges_;
};

struct NaiveHalfEdge {
  CellId cell;
  VertexId from, to;
};

// Half-edges of M_L without a partner, by their own cell and local ids. Paired within a cell first; where cells leave a
// choice, the last ones remain.
inline std::vector<NaiveHalfEdge> naive_unpaired(const Hierarchy& hierarchy) {
  // By the edge's identity and the cell: half-edges along it and against it.
  using Both = std::array<std::vector<NaiveHalfEdge>, 2>;
  std::map<std::pair<Identity, Identity>, std::map<CellId, Both>> edges;
  for (CellId c = first_leaf(hierarchy); c < hierarchy.cells.size(); ++c)
    for (const Triangle& t : hierarchy.cells[c].triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId from(t.v[k]), to(t.v[(k + 1) % 3]);
        const Identity a = identity(hierarchy, c, from), b = identity(hierarchy, c, to);
        edges[{std::min(a, b), std::max(a, b)}][c][a < b ? 0 : 1].push_back({c, from, to});
      }
  std::vector<NaiveHalfEdge> unpaired;
  for (auto& [ends, cells] : edges) {
    std::array<std::vector<NaiveHalfEdge>, 2> left;
    for (auto& [cell, both] : cells) {
      const std::size_t pairs = std::min(both[0].size(), both[1].size());
      for (std::size_t side = 0; side < 2; ++side)
        left[side].insert(left[side].end(), both[side].begin() + static_cast<std::ptrdiff_t>(pairs), both[side].end());
    }
    const std::size_t pairs = std::min(left[0].size(), left[1].size());
    for (const auto& side : left)
      unpaired.insert(unpaired.end(), side.begin() + static_cast<std::ptrdiff_t>(pairs), side.end());
  }
  return unpaired;
}

inline std::uint64_t naive_residual_edges(const MorphContext& context, const Selection& selection) {
  const Hierarchy& h = *context.hierarchy;
  const std::set<CellId> drawn = drawn_cells(selection);
  NaiveChain chain;
  for (const CellId cell : drawn) {
    std::vector<Vec3f> positions(h.cells[cell].positions.size());
    morph_cell(context, cell, positions);
    for (const Triangle& t : h.cells[cell].triangles)
      for (std::size_t k = 0; k < 3; ++k) chain.add(positions[t.v[k]], positions[t.v[(k + 1) % 3]], 1);
  }
  for (const NaiveHalfEdge& e : naive_unpaired(h))
    chain.add(draw_vertex(context, drawn, e.cell, e.from).position, draw_vertex(context, drawn, e.cell, e.to).position,
              -1);
  return chain.residual();
}

// On the screen, of what has an end in the picture and none behind the eye; negative otherwise.
inline double naive_pixels(const Screen& screen, Vec3f from, Vec3f to) {
  const auto a = screen.project(to_double(from)), b = screen.project(to_double(to));
  if (!a || !b || !(a->inside || b->inside)) return -1;
  return std::hypot(a->x - b->x, a->y - b->y);
}

inline GapReport naive_vertex_gaps(const MorphContext& context, const Selection& selection,
                                   const Screen* screen = nullptr) {
  const Hierarchy& h = *context.hierarchy;
  const std::set<CellId> drawn = drawn_cells(selection);
  std::map<Identity, std::vector<Vec3f>> places;
  for (CellId c = first_leaf(h); c < h.cells.size(); ++c)
    for (VertexId v{0}; v < h.cells[c].positions.size(); ++v)
      places[identity(h, c, v)].push_back(draw_vertex(context, drawn, c, v).position);
  GapReport report;
  double sum = 0;
  for (const auto& [id, at] : places)
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = i + 1; j < at.size(); ++j) {
        if (at[i] == at[j]) continue;
        const double gap = length(to_double(at[i]) - to_double(at[j]));
        ++report.gaps;
        sum += gap;
        report.gap_max = std::max(report.gap_max, gap);
        const double pixels = screen ? naive_pixels(*screen, at[i], at[j]) : -1;
        if (pixels < 0) continue;
        ++report.gaps_in_view;
        report.gap_max_pixels = std::max(report.gap_max_pixels, pixels);
        report.gap_mean_pixels += pixels;
      }
  if (report.gaps_in_view > 0) report.gap_mean_pixels /= static_cast<double>(report.gaps_in_view);
  report.gap_mean = report.gaps ? sum / static_cast<double>(report.gaps) : 0;
  return report;
}

struct NaivePops {
  double max_jump = 0, jump_over_bound = 0;
};

inline NaivePops naive_largest_jump(const MorphContext& before, const Selection& selected_before,
                                    const MorphContext& after, const Selection& selected_after) {
  const Hierarchy& h = *before.hierarchy;
  const std::set<CellId> drawn_before = drawn_cells(selected_before), drawn_after = drawn_cells(selected_after);
  const std::vector<double> bounds = jump_bounds(before, after);
  NaivePops pops;
  for (CellId c = first_leaf(h); c < h.cells.size(); ++c)
    for (VertexId v{0}; v < h.cells[c].positions.size(); ++v) {
      const DrawnVertex a = draw_vertex(before, drawn_before, c, v), b = draw_vertex(after, drawn_after, c, v);
      double bound = 0;
      for (int l = std::min(a.level, b.level); l <= std::max(a.level, b.level); ++l)
        bound = std::max(bound, bounds[static_cast<std::size_t>(l)]);
      const double jump = length(to_double(a.position) - to_double(b.position));
      pops.max_jump = std::max(pops.max_jump, jump);
      pops.jump_over_bound = std::max(pops.jump_over_bound, jump_ratio(jump, bound));
    }
  return pops;
}

// All jumps of the vertices that the metric looks at: those of each drawn cell that a cell of the other frame draws,
// too, itself or an ancestor.
struct NaiveJumps {
  std::vector<double> jumps, pixels;  // pixels: of what is in view
};

inline NaiveJumps naive_jumps(const MorphContext& before, const Selection& selected_before, const MorphContext& after,
                              const Selection& selected_after, const Screen& screen) {
  const Hierarchy& h = *before.hierarchy;
  const std::set<CellId> drawn_before = drawn_cells(selected_before), drawn_after = drawn_cells(selected_after);
  std::set<CellId> finer;
  for (const auto& [own, other] : {std::pair(&drawn_before, &drawn_after), std::pair(&drawn_after, &drawn_before)})
    for (const CellId cell : *own)
      for (CellId c = cell; c != no_cell; c = h.cells[c].parent)
        if (other->contains(c)) finer.insert(cell);
  NaiveJumps all;
  for (const CellId cell : finer)
    for (VertexId v{0}; v < h.cells[cell].positions.size(); ++v) {
      const Vec3f a = draw_vertex(before, drawn_before, cell, v).position,
                  b = draw_vertex(after, drawn_after, cell, v).position;
      all.jumps.push_back(length(to_double(a) - to_double(b)));
      const double pixels = naive_pixels(screen, a, b);
      if (pixels >= 0) all.pixels.push_back(pixels);
    }
  std::sort(all.jumps.begin(), all.jumps.end());
  std::sort(all.pixels.begin(), all.pixels.end());
  return all;
}

}  // namespace lodestone::testing
