// Check of the errors, with search structures over whole levels: estimates of the builder, which searches around the
// parents only, are recomputed. Distances at sample points, both ways, are compared with measured errors, which are
// bounds, and with estimates to see by how much these are too small.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

// The surface of a level, of which each peer has the part of its cells. Called by all peers.
class PartSurface {
 public:
  // Without regard to identity: copies of a vertex do not matter to distances. With points: vertices that no triangle
  // of their cell uses, as triangles without extent.
  PartSurface(const Part& part, int level, bool with_points) : part_(part) {
    std::vector<Vec3d> positions;
    std::vector<Triangle> triangles;
    std::vector<char> used;
    Box3f box;
    std::size_t vertices = 0, faces = 0;
    part.for_cells(level, [&](CellId c) {
      vertices += part.hierarchy.cells[c].positions.size(), faces += part.hierarchy.cells[c].triangles.size();
    });
    positions.reserve(vertices), triangles.reserve(faces);
    part.for_cells(level, [&](CellId c) {
      const Cell& cell = part.hierarchy.cells[c];
      const auto first = static_cast<std::uint32_t>(positions.size());
      used.assign(cell.positions.size(), 0);
      for (const Vec3f p : cell.positions) positions.push_back(to_double(p)), box.extend(p);
      for (const Triangle& t : cell.triangles) {
        triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
        for (const std::uint32_t v : t.v) used[v] = 1;
      }
      for (std::uint32_t v = 0; with_points && v < used.size(); ++v)
        if (!used[v]) triangles.push_back({{v + first, v + first, v + first}});
    });
    if (!triangles.empty()) own_.emplace(positions, triangles);
    for (const std::vector<Box3f>& of_peer : part.share(own_ ? std::vector{box} : std::vector<Box3f>{}))
      boxes_.push_back(of_peer.empty() ? std::nullopt : std::optional(of_peer.front()));
  }

  // Squared distances; infinity if there is no triangle. Peers are asked for points that are nearer to the box of their
  // part than to any other surface known so far.
  [[nodiscard]] std::vector<double> squared_distances(const std::vector<Vec3d>& points) const {
    std::vector<double> distances = of_own(points);
    if (part_.peers() == 1) return distances;
    std::vector<std::vector<std::size_t>> asked(part_.peers());
    std::vector<std::vector<Vec3d>> questions(part_.peers());
    for (std::size_t p = 0; p < part_.peers(); ++p)
      for (std::size_t i = 0; p != part_.index() && boxes_[p] && i < points.size(); ++i)
        if (squared_distance(points[i], *boxes_[p]) < distances[i]) {
          asked[p].push_back(i);
          questions[p].push_back(points[i]);
        }
    std::vector<std::vector<double>> answers;
    for (const std::vector<Vec3d>& question : part_.exchange(questions)) answers.push_back(of_own(question));
    answers = part_.exchange(answers);
    for (std::size_t p = 0; p < part_.peers(); ++p)
      for (std::size_t k = 0; k < asked[p].size(); ++k)
        distances[asked[p][k]] = std::min(distances[asked[p][k]], answers[p].at(k));
    return distances;
  }

 private:
  [[nodiscard]] std::vector<double> of_own(const std::vector<Vec3d>& points) const {
    std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
    std::uint32_t hint = TriangleBvh::no_hint;
    for (std::size_t i = 0; own_ && i < points.size(); ++i) {
      const TriangleBvh::Nearest nearest = own_->nearest(points[i], hint);
      hint = nearest.slot;
      distances[i] = nearest.squared_distance;
    }
    return distances;
  }

  const Part& part_;
  std::optional<TriangleBvh> own_;
  std::vector<std::optional<Box3f>> boxes_;  // by peer
};

// The error of the signature of a vertex, which covers the triangles around it; that of the cell, if it has none.
double error_around(const Hierarchy& hierarchy, CellId cell, std::uint32_t vertex) {
  const Cell& in = hierarchy.cells[cell];
  if (!hierarchy.signatures || vertex < in.first_shared()) return in.error;
  const std::uint8_t at = hierarchy.signatures->places(cell)[vertex - in.first_shared()];
  return at == 0 ? in.error : hierarchy.signatures->error(hierarchy.signatures->of(cell)[at]);
}

// Least errors of the vertices of a level's cells here, by rank. A vertex has the largest sum, of those that it stands
// for, of their own error and their distance from the coarser surface.
using VertexErrors = std::vector<std::vector<double>>;

VertexErrors finest_errors(const Part& part) {
  const Level& finest = part.hierarchy.levels.back();
  VertexErrors errors(finest.cell_count);
  part.for_cells(part.hierarchy.finest(), [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    errors[finest.rank_of(c)].assign(cell.positions.size(), double{cell.error});
  });
  return errors;
}

// Calls body(parent, child, vertex, number) for the vertices of the cells here below the coarse level; numbers are
// those among all vertices of the finer level.
template <class Body>
void for_vertices_below(const Part& part, int coarse, Body&& body) {
  std::uint64_t number = 0;
  for (CellId c = part.level(coarse).first_cell; c < part.level(coarse).end_cell(); ++c)
    for (CellId k = part.hierarchy.cells[c].first_child; k < part.hierarchy.cells[c].end_child(); ++k) {
      const std::size_t vertices = part.hierarchy.cells[k].positions.size();
      for (VertexId v{0}; part.has(k) && v < vertices; ++v) body(c, k, v, number + v);
      number += vertices;
    }
}

// Each cell's to the peer that has the cell, from the one that has its children.
void send_to_owners(const Part& part, int level, VertexErrors& errors) {
  struct VertexError {
    CellId cell;
    std::uint32_t vertex = 0;
    double error = 0;
  };
  std::vector<std::vector<VertexError>> out(part.peers());
  part.for_parents(level, [&](CellId c) {
    if (part.has(c)) return;
    std::vector<double>& of_cell = errors[part.level(level).rank_of(c)];
    for (std::uint32_t v = 0; v < of_cell.size(); ++v) out[part.owner(c)].push_back({c, v, of_cell[v]});
    of_cell = {};
  });
  for (const std::vector<VertexError>& of_peer : part.exchange(out))
    for (const VertexError& e : of_peer) {
      std::vector<double>& of_cell = errors[part.level(level).rank_of(e.cell)];
      of_cell.resize(part.hierarchy.cells[e.cell].positions.size());
      of_cell.at(e.vertex) = e.error;
    }
}

// Estimated errors: that of a cell bounds those of its vertices, and that of a signature those of its own. From the
// vertices of the finer level to those of the coarse one.
VertexErrors check_estimated(const Part& part, int coarse, const VertexErrors& below, Finding& errors) {
  const Hierarchy& hierarchy = part.hierarchy;
  const Level &level = part.level(coarse), &finer = part.level(coarse + 1);
  VertexErrors made(level.cell_count);
  part.for_parents(coarse, [&](CellId c) { made[level.rank_of(c)].resize(hierarchy.cells[c].positions.size()); });
  // Vertices that do not move need no measurement.
  const std::uint64_t stride = 1 + finer.vertices / vertices_measured;
  const auto parent_of = [&](CellId c, CellId k, VertexId v) {
    return hierarchy.cells[c].positions[hierarchy.cells[k].parents[v]];
  };
  const auto is_measured = [&](CellId c, CellId k, VertexId v, std::uint64_t number) {
    return number % stride == 0 && level.triangles > 0 && hierarchy.cells[k].positions[v] != parent_of(c, k, v);
  };
  std::vector<Vec3d> points;
  for_vertices_below(part, coarse, [&](CellId c, CellId k, VertexId v, std::uint64_t number) {
    if (is_measured(c, k, v, number)) points.push_back(to_double(hierarchy.cells[k].positions[v]));
  });
  const std::vector<double> distances = PartSurface(part, coarse, false).squared_distances(points);
  std::size_t measured = 0;
  for_vertices_below(part, coarse, [&](CellId c, CellId k, VertexId v, std::uint64_t number) {
    const Cell &cell = hierarchy.cells[c], &child = hierarchy.cells[k];
    double needed = below[finer.rank_of(k)][v];
    if (is_measured(c, k, v, number)) {
      // The image of an island that has collapsed is a point or a line: it counts, although it is not drawn.
      const double moved2 = squared_length(to_double(child.positions[v]) - to_double(parent_of(c, k, v)));
      needed += std::sqrt(std::min(distances[measured++], moved2));
    }
    double& error = made[level.rank_of(c)][child.parents[v]];
    error = std::max(error, needed);
    errors.require(cell.error * (1 + relative_slack) + absolute_slack >= needed, [&] {
      return place(coarse + 1, k, v) + ": " + std::to_string(needed) + " from M_L, but the parent cell's error is " +
             std::to_string(cell.error);
    });
    const double around = error_around(hierarchy, c, child.parents[v]);
    errors.require(around * (1 + relative_slack) + absolute_slack >= needed, [&] {
      return place(coarse + 1, k, v) + ": " + std::to_string(needed) +
             " from M_L, but the error of its parent's signature is " + std::to_string(around);
    });
  });
  send_to_owners(part, coarse, made);
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
  DistanceSamples(const Part& part, std::size_t most)
      : part_(part), most_(most), finest_(part, part.hierarchy.finest(), false) {
    const Level& level = part.hierarchy.levels.back();
    ancestor_.resize(level.cell_count);
    for (std::uint32_t k = 0; k < ancestor_.size(); ++k) ancestor_[k] = CellId(level.first_cell + k);
  }

  // Calls visit(cell, distance) for cells of level l. Called for one level after the other, beginning below the finest.
  template <class Visit>
  void sample(int l, const Visit& visit) {
    const Hierarchy& hierarchy = part_.hierarchy;
    for (CellId& cell : ancestor_) cell = hierarchy.cells[cell].parent;
    measure(l, finest_, visit);
    const CellId first = hierarchy.levels.back().first_cell;
    measure(hierarchy.finest(), PartSurface(part_, l, true),
            [&](CellId cell, double distance) { visit(ancestor_[cell - first], distance); });
  }

 private:
  // Distances of triangles of a level from the other surface, with the cell of the triangle.
  template <class Visit>
  void measure(int from, const PartSurface& surface, const Visit& visit) {
    const Level& level = part_.level(from);
    const std::uint64_t stride = 1 + level.triangles * 7 / most_;
    std::vector<Vec3d> points;
    std::vector<CellId> cells;
    std::uint64_t number = 0;  // of a triangle of the level
    for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
      const Cell& cell = part_.hierarchy.cells[c];
      for (std::size_t t = (stride - number % stride) % stride; part_.has(c) && t < cell.triangles.size(); t += stride)
        for (const Vec3d p : samples_of(cell, cell.triangles[t])) points.push_back(p), cells.push_back(c);
      number += cell.triangles.size();
    }
    const std::vector<double> distances = surface.squared_distances(points);
    for (std::size_t i = 0; i < points.size(); ++i) visit(cells[i], std::sqrt(distances[i]));
  }

  const Part& part_;
  std::size_t most_;
  PartSurface finest_;
  std::vector<CellId> ancestor_;  // of each finest cell, on the level at hand
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

// Checks the tables of a level. Returns its largest error.
float check_stored_errors(const Part& part, int l, const std::vector<Allowed>& allowed, Finding& errors) {
  const Hierarchy& hierarchy = part.hierarchy;
  const Level& level = part.level(l);
  float largest = 0;
  for (const Cell& cell : hierarchy.cells_of(l)) largest = std::max(largest, cell.error);
  if (!part.has_tables()) return largest;
  for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
    const double error = hierarchy.cells[c].error;
    errors.require(error >= allowed[c].min && error <= allowed[c].max * (1 + 1e-6), [&] {
      return place(l, c) + ": error " + std::to_string(error) + " stored, its children allow " +
             std::to_string(allowed[c].min) + " to " + std::to_string(allowed[c].max);
    });
  }
  check_bound(errors, "error", l, level.error, largest / hierarchy.cell_size(l));
  if (hierarchy.signatures) check_signature_errors(hierarchy, l, errors);
  return largest;
}

}  // namespace

std::vector<double> check_errors(const Part& part, Finding& errors) {
  const Hierarchy& hierarchy = part.hierarchy;
  const std::vector<Allowed> allowed = allowed_errors(hierarchy);
  const bool measured = hierarchy.provenance.measured_errors;
  DistanceSamples samples(part, measured ? vertices_measured : points_compared);
  std::vector<double> ratio(hierarchy.levels.size());
  VertexErrors of_vertices = measured ? VertexErrors{} : finest_errors(part);
  for (int l = hierarchy.finest(); l >= 0; --l) {
    const float largest = check_stored_errors(part, l, allowed, errors);
    if (l == hierarchy.finest()) continue;
    if (!measured) of_vertices = check_estimated(part, l, of_vertices, errors);
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
    farthest = part.maxima({farthest}).front();
    if (farthest > absolute_slack)
      ratio[static_cast<std::size_t>(l)] = farthest / std::max(double{largest}, absolute_slack);
  }
  return ratio;
}

}  // namespace lodestone::verify
