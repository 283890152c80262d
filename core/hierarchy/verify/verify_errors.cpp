// Check of the errors, with search structures over whole levels: estimates of the builder, which searches around the
// parents only, are recomputed. Distances at sample points, both ways, are compared with measured errors, which are
// bounds, and with estimates to see by how much these are too small.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/hierarchy/model/signatures.h"
#include "core/hierarchy/verify/verify_checks.h"
#include "core/spatial/triangle_bvh.h"

namespace lodestone::verify {
namespace {

// Six digits, however small the number.
std::string in_digits(double number) {
  std::ostringstream text;
  text.exceptions(std::ios::badbit);  // no memory
  text << number;
  return text.str();
}

// The builder's errors are bounds; this is the rounding of distances in double precision, here and there.
constexpr double relative_slack = 1e-6, absolute_slack = 1e-10;

constexpr std::size_t vertices_measured = 250'000;  // per level, about
constexpr std::size_t points_compared = 100'000;    // with estimates, per level and direction, about

// The surface of a level without regard to identity: copies of a vertex do not matter to distances. With points:
// vertices that no triangle of their cell uses, as triangles without extent.
TriangleBvh surface_of(const Hierarchy& hierarchy, int level, bool with_points) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  std::vector<char> used;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    used.assign(cell.positions.size(), 0);
    for (const Vec3f p : cell.positions) positions.push_back(to_double(p));
    for (const Triangle& t : cell.triangles) {
      triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
      for (const std::uint32_t v : t.v) used[v] = 1;
    }
    for (std::uint32_t v = 0; with_points && v < used.size(); ++v)
      if (!used[v]) triangles.push_back({{v + first, v + first, v + first}});
  }
  return TriangleBvh(positions, triangles);
}

// The error of the signature of a vertex, which covers the triangles around it; that of the cell, if it has none.
double error_around(const Hierarchy& hierarchy, CellId cell, std::uint32_t vertex) {
  const Cell& in = hierarchy.cells[cell];
  if (!hierarchy.signatures || vertex < in.first_shared()) return in.error;
  const std::uint8_t at = hierarchy.signatures->places(cell)[vertex - in.first_shared()];
  return at == 0 ? in.error : hierarchy.signatures->error(hierarchy.signatures->of(cell)[at]);
}

// Least errors of the vertices of a level's cells, by rank. A vertex has the largest sum, of those that it stands for,
// of their own error and their distance from the coarser surface.
using VertexErrors = std::vector<std::vector<double>>;

VertexErrors finest_errors(const Hierarchy& hierarchy) {
  VertexErrors errors;
  for (const Cell& cell : hierarchy.cells_of(hierarchy.finest()))
    errors.emplace_back(cell.positions.size(), double{cell.error});
  return errors;
}

// Estimated errors: that of a cell bounds those of its vertices, and that of a signature those of its own. From the
// vertices of the finer level to those of the coarse one.
VertexErrors check_estimated(const Hierarchy& hierarchy, int coarse, const VertexErrors& below, Finding& errors) {
  const Level &level = hierarchy.levels[static_cast<std::size_t>(coarse)],
              &finer = hierarchy.levels[static_cast<std::size_t>(coarse) + 1];
  VertexErrors made;
  for (const Cell& cell : hierarchy.cells_of(coarse)) made.emplace_back(cell.positions.size(), 0.0);
  std::optional<TriangleBvh> surface;
  if (level.triangles > 0) surface.emplace(surface_of(hierarchy, coarse, false));
  const std::size_t stride = 1 + finer.vertices / vertices_measured;
  std::uint32_t hint = TriangleBvh::no_hint;
  std::size_t number = 0;
  for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
    const Cell& cell = hierarchy.cells[c];
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
      const Cell& child = hierarchy.cells[k];
      for (VertexId v{0}; v < child.positions.size(); ++v) {
        double needed = below[finer.rank_of(k)][v];
        const std::uint32_t parent = child.parents[v];
        // Vertices that do not move need no measurement.
        if (number++ % stride == 0 && surface && child.positions[v] != cell.positions[parent]) {
          const TriangleBvh::Nearest nearest = surface->nearest(to_double(child.positions[v]), hint);
          hint = nearest.slot;
          // The image of an island that has collapsed is a point or a line: it counts, although it is not drawn.
          const double moved2 = squared_length(to_double(child.positions[v]) - to_double(cell.positions[parent]));
          needed += std::sqrt(std::min(nearest.squared_distance, moved2));
        }
        double& error = made[level.rank_of(c)][parent];
        error = std::max(error, needed);
        errors.require(cell.error * (1 + relative_slack) + absolute_slack >= needed, [&] {
          return place(coarse + 1, k, v) + ": " + std::to_string(needed) +
                 " from M_L, but the parent cell's error is " + std::to_string(cell.error);
        });
        const double around = error_around(hierarchy, c, parent);
        errors.require(around * (1 + relative_slack) + absolute_slack >= needed, [&] {
          return place(coarse + 1, k, v) + ": " + std::to_string(needed) +
                 " from M_L, but the error of its parent's signature is " + std::to_string(around);
        });
      }
    }
  }
  return made;
}

// Points of a triangle at which distances are compared.
std::array<Vec3d, 7> samples_of(const Cell& cell, const Triangle& t) {
  const Vec3d a = to_double(cell.positions[t.v[0]]), b = to_double(cell.positions[t.v[1]]),
              c = to_double(cell.positions[t.v[2]]);
  return {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (1.0 / 3) * ((a + b) + c)};
}

// Distances between a level and the finest, both ways, of corners, middles of edges and middles of triangles, of a
// regular sample on large levels.
class DistanceSamples {
 public:
  DistanceSamples(const Hierarchy& hierarchy, std::size_t most)
      : hierarchy_(hierarchy), most_(most), finest_(surface_of(hierarchy, hierarchy.finest(), false)) {
    ancestor_.resize(hierarchy.levels.back().cell_count);
    const Level& level = hierarchy.levels.back();
    for (std::uint32_t k = 0; k < ancestor_.size(); ++k) ancestor_[k] = CellId(level.first_cell + k);
  }

  // Calls visit(cell, distance) for cells of level l. Called for one level after the other, beginning below the finest.
  template <class Visit>
  void sample(int l, const Visit& visit) {
    for (CellId& cell : ancestor_) cell = hierarchy_.cells[cell].parent;
    const Level &level = hierarchy_.levels[static_cast<std::size_t>(l)], &fine = hierarchy_.levels.back();
    const std::size_t stride = 1 + level.triangles * 7 / most_;
    std::size_t number = 0;
    for (CellId c = level.first_cell; c < level.end_cell(); ++c)
      for (const Triangle& t : hierarchy_.cells[c].triangles)
        if (number++ % stride == 0) measure(hierarchy_.cells[c], t, finest_, [&](double d) { visit(c, d); });
    const TriangleBvh surface = surface_of(hierarchy_, l, true);
    const std::size_t fine_stride = 1 + fine.triangles * 7 / most_;
    number = 0;
    for (std::uint32_t k = 0; k < fine.cell_count; ++k)
      for (const Triangle& t : hierarchy_.cells[fine.first_cell + k].triangles)
        if (number++ % fine_stride == 0)
          measure(hierarchy_.cells[fine.first_cell + k], t, surface, [&](double d) { visit(ancestor_[k], d); });
  }

 private:
  // Distances of a triangle of `from` from the other surface.
  template <class Visit>
  void measure(const Cell& from, const Triangle& t, const TriangleBvh& surface, const Visit& visit) {
    for (const Vec3d p : samples_of(from, t)) visit(std::sqrt(surface.nearest(p, hint_).squared_distance));
  }

  const Hierarchy& hierarchy_;
  std::size_t most_;
  TriangleBvh finest_;
  std::vector<CellId> ancestor_;  // of each finest cell, on the level at hand
  std::uint32_t hint_ = TriangleBvh::no_hint;
};

// Error of the finest level: a corner of the input is at most half a diagonal of the lattice from its vertex, and so is
// every point between; a new vertex on an edge is rounded once more.
double moved_by_lattice(const Hierarchy& hierarchy) {
  const int bits = hierarchy.transform.lattice.bits;
  if (bits == 0) return 0;
  return (hierarchy.provenance.refined ? 2 : 1) * std::sqrt(0.75) * std::ldexp(1.0, -bits);
}

// Range of a cell's error, estimated or measured: its distance from M_L is at most the sum of the movements of its
// vertices on all levels. A measured error may be too large by the tolerance, and only the ends remain of a triangle
// that has collapsed to a segment.
struct Allowed {
  double min = 0, max = 0;
};
constexpr double measured_slack = 0.06;

std::vector<Allowed> allowed_errors(const Hierarchy& hierarchy) {
  const bool measured = hierarchy.provenance.measured_errors;
  const double longest = double{hierarchy.levels.back().max_edge} * hierarchy.cell_size(hierarchy.finest());
  std::vector<Allowed> allowed(hierarchy.cells.size());
  std::vector<double> moved(hierarchy.cells.size());
  for (std::size_t c = hierarchy.cells.size(); c-- > 0;) {
    const Cell& cell = hierarchy.cells[c];
    if (cell.child_count == 0) allowed[c].min = allowed[c].max = moved_by_lattice(hierarchy);
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
      const Cell& child = hierarchy.cells[k];
      moved[c] = std::max(moved[c], moved[k] + child.max_displacement);
      allowed[c].min = std::max(allowed[c].min, double{child.error});
      allowed[c].max = measured ? std::max(allowed[c].max, double{child.error})
                                : std::max(allowed[c].max, double{child.error} + child.max_displacement);
    }
    if (measured && cell.child_count > 0)
      allowed[c].max =
          std::max(allowed[c].max, moved_by_lattice(hierarchy) + (1 + measured_slack) * (moved[c] + longest));
  }
  return allowed;
}

// Errors of signatures are parts of those of their cells.
void check_signature_errors(const Hierarchy& hierarchy, int level, Finding& errors) {
  const Signatures& signatures = *hierarchy.signatures;
  const std::uint32_t first = signatures.first(level) + hierarchy.levels[static_cast<std::size_t>(level)].cell_count;
  for (std::uint32_t s = first; s < signatures.first(level + 1); ++s) {
    float largest = 0;
    for (const CellId cell : signatures.users(s).cells) largest = std::max(largest, hierarchy.cells[cell].error);
    errors.require(signatures.error(s) <= largest, [&] {
      return place(level, signatures.users(s).cells.front()) + ": error " + in_digits(signatures.error(s)) +
             " of a signature, of its cells at most " + in_digits(largest);
    });
  }
}

}  // namespace

std::vector<double> check_errors(const Hierarchy& hierarchy, Finding& errors) {
  const std::vector<Allowed> allowed = allowed_errors(hierarchy);
  const bool measured = hierarchy.provenance.measured_errors;
  DistanceSamples samples(hierarchy, measured ? vertices_measured : points_compared);
  std::vector<double> ratio(hierarchy.levels.size());
  VertexErrors of_vertices = measured ? VertexErrors{} : finest_errors(hierarchy);
  for (int l = hierarchy.finest(); l >= 0; --l) {
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    double largest = 0;
    for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
      const double error = hierarchy.cells[c].error;
      errors.require(error >= allowed[c].min && error <= allowed[c].max * (1 + 1e-6), [&] {
        return place(l, c) + ": error " + std::to_string(error) + " stored, its children allow " +
               std::to_string(allowed[c].min) + " to " + std::to_string(allowed[c].max);
      });
      largest = std::max(largest, error);
    }
    check_bound(errors, "error", l, level.error, largest / hierarchy.cell_size(l));
    if (hierarchy.signatures) check_signature_errors(hierarchy, l, errors);
    if (l == hierarchy.finest()) continue;
    if (!measured) of_vertices = check_estimated(hierarchy, l, of_vertices, errors);
    double farthest = 0;
    samples.sample(l, [&](CellId cell, double distance) {
      farthest = std::max(farthest, distance);
      const double error = hierarchy.cells[cell].error;
      if (measured)
        errors.require(distance <= error * (1 + relative_slack), [&] {
          const auto in_cells = [h = hierarchy.cell_size(l)](double d) { return in_digits(d / h) + " h"; };
          return place(l, cell) + ": a point is " + in_cells(distance) +
                 " from the other surface, the error stored is " + in_cells(error);
        });
    });
    if (farthest > absolute_slack) ratio[static_cast<std::size_t>(l)] = farthest / std::max(largest, absolute_slack);
  }
  return ratio;
}

}  // namespace lodestone::verify
