// Checks of lengths, boxes and stored bounds, in double.
#include <algorithm>

#include "core/hierarchy/verify/verify_checks.h"

namespace lodestone::verify {
namespace {

double distance(Vec3f a, Vec3f b) { return length(to_double(a) - to_double(b)); }

// Edges whose length differs from sigma0 h_l by less than this share may count as long or not: float and double differ.
constexpr double edge_slack = 1e-6;

struct LevelEdges {
  double longest = 0;
  std::uint64_t surely_long = 0, perhaps_long = 0;  // perhaps_long includes surely_long
};

// By level, of all peers.
std::vector<LevelEdges> edges_of(const Part& part) {
  std::vector<LevelEdges> found;
  for (int l = 0; l <= part.hierarchy.finest(); ++l) {
    LevelEdges& level = found.emplace_back();
    const double limit = double{part.hierarchy.sigma0} * part.hierarchy.cell_size(l);
    part.for_cells(l, [&](CellId c) {
      const Cell& cell = part.hierarchy.cells[c];
      for (const Triangle& t : cell.triangles)
        for (std::size_t e = 0; e < 3; ++e) {
          const double edge = distance(cell.positions[t.v[e]], cell.positions[t.v[(e + 1) % 3]]);
          level.longest = std::max(level.longest, edge);
          level.surely_long += edge > limit * (1 + edge_slack);
          level.perhaps_long += edge > limit * (1 - edge_slack);
        }
    });
  }
  return part.reduce(found, [](const LevelEdges& a, const LevelEdges& b) {
    return LevelEdges{std::max(a.longest, b.longest), a.surely_long + b.surely_long, a.perhaps_long + b.perhaps_long};
  });
}

Vec3d to_farthest_corner(Vec3f p, const Box3f& box) {
  const auto far = [](double lo, double hi, double v) { return std::max(v - lo, hi - v); };
  return {far(box.lo.x, box.hi.x, p.x), far(box.lo.y, box.hi.y, p.y), far(box.lo.z, box.hi.z, p.z)};
}

}  // namespace

void check_bound(Finding& finding, const char* what, int level, float stored, double exact) {
  finding.require(is_tight_bound(stored, exact), [&] {
    return "level " + std::to_string(level) + ": " + what + " " + std::to_string(stored) + " stored, " +
           std::to_string(exact) + " recomputed";
  });
}

void check_displacements(const Part& part, Finding& displacement) {
  const Hierarchy& hierarchy = part.hierarchy;
  if (part.has_tables())
    displacement.require(hierarchy.cells[0].max_displacement == 0, [] { return "the root cell has a displacement"; });
  for (int l = 1; l <= hierarchy.finest(); ++l) {
    const double h = hierarchy.cell_size(l), limit = double{hierarchy.sigma0} * h / 2;
    part.for_cells(l, [&](CellId c) {
      const Cell& cell = hierarchy.cells[c];
      const auto& above = hierarchy.cells[cell.parent].positions;
      double largest = 0;
      for (VertexId v{0}; v < cell.positions.size(); ++v) {
        const double moved = distance(cell.positions[v], above[cell.parents[v]]);
        displacement.require(moved <= limit, [&] {
          return place(l, c, v) + ": moves by " + std::to_string(moved / h) + " h to its parent, more than " +
                 std::to_string(limit / h) + " h";
        });
        largest = std::max(largest, moved);
      }
      displacement.require(is_tight_bound(cell.max_displacement, largest), [&] {
        return place(l, c) + ": largest displacement " + std::to_string(cell.max_displacement) + " stored, " +
               std::to_string(largest) + " recomputed";
      });
    });
  }
}

void check_lattice(const Part& part, Finding& lattice) {
  const Hierarchy& hierarchy = part.hierarchy;
  if (!hierarchy.transform.lattice) return;
  for (int l = 0; l <= hierarchy.finest(); ++l)
    part.for_cells(l, [&](CellId c) {
      for (VertexId v{0}; v < hierarchy.cells[c].positions.size(); ++v)
        lattice.require(hierarchy.transform.lattice.holds(hierarchy.cells[c].positions[v]),
                        [&] { return place(l, c, v) + ": not on the lattice"; });
    });
}

// The image of an edge of at most sigma0 h_l has at most 2 sigma0 h_l: where that is sigma0 h_{l-1}, long edges of a
// coarse level come from long edges of the finer one.
void check_edges(const Part& part, Finding& edges) {
  const Hierarchy& hierarchy = part.hierarchy;
  const std::vector<LevelEdges> by_level = edges_of(part);
  if (!part.has_tables()) return;
  bool all_short = true;
  edges.require(!hierarchy.provenance.refined || by_level.back().surely_long == 0,
                [] { return "an edge of the finest level is longer than sigma0 h, although such edges were split"; });
  for (int l = hierarchy.finest(); l >= 0; --l) {
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    const LevelEdges& found = by_level[static_cast<std::size_t>(l)];
    check_bound(edges, "longest edge", l, level.max_edge, found.longest / hierarchy.cell_size(l));
    edges.require(level.long_edges >= found.surely_long && level.long_edges <= found.perhaps_long, [&] {
      return "level " + std::to_string(l) + ": " + std::to_string(level.long_edges) + " long half-edges stored, " +
             std::to_string(found.surely_long) + " found";
    });
    if (l < hierarchy.finest() && !hierarchy.grids.keeps_cells(l + 1))
      edges.require(!all_short || found.surely_long == 0, [&] {
        return "level " + std::to_string(l) + ": " + std::to_string(found.surely_long) +
               " half-edges longer than sigma0 h, and none on the finer level";
      });
    all_short = found.perhaps_long == 0;
  }
}

void check_boxes(const Part& part, Finding& boxes) {
  for (int l = 0; l <= part.hierarchy.finest(); ++l)
    part.for_cells(l, [&](CellId c) {
      const Cell& cell = part.hierarchy.cells[c];
      Box3f box;
      for (const Vec3f p : cell.positions) box.extend(p);
      for (CellId k = cell.first_child; k < cell.end_child(); ++k) box.extend(part.hierarchy.cells[k].bounds);
      boxes.require(box == cell.bounds,
                    [&] { return place(l, c) + ": not the box of its vertices and of its children's boxes"; });
    });
}

void check_reach(const Part& part, Finding& reach) {
  const Hierarchy& hierarchy = part.hierarchy;
  for (int l = 0; l <= hierarchy.finest(); ++l) {
    double euclidean = 0, chebyshev = 0, diameter = 0;
    part.for_cells(l, [&](CellId c) {
      const Cell& cell = hierarchy.cells[c];
      diameter = std::max(diameter, distance(cell.bounds.lo, cell.bounds.hi));
      for (const Vec3f p : cell.positions) {
        const Vec3d far = to_farthest_corner(p, cell.bounds);
        euclidean = std::max(euclidean, length(far));
        chebyshev = std::max({chebyshev, far.x, far.y, far.z});
      }
    });
    const std::vector<double> found = part.maxima({euclidean, chebyshev, diameter});
    if (!part.has_tables()) continue;
    const Level& level = part.level(l);
    const double h = hierarchy.cell_size(l);
    check_bound(reach, "Euclidean reach", l, level.reach[static_cast<int>(DistanceMetric::euclidean)], found[0] / h);
    check_bound(reach, "Chebyshev reach", l, level.reach[static_cast<int>(DistanceMetric::chebyshev)], found[1] / h);
    check_bound(reach, "diameter", l, level.diameter, found[2] / h);
  }
}

}  // namespace lodestone::verify
