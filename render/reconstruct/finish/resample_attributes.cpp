#include "render/reconstruct/finish/resample_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/disjoint_sets.h"
#include "core/mesh/raw_mesh.h"
#include "core/mesh/wedges.h"
#include "render/reconstruct/finish/surface_walk.h"

namespace lodestone {
namespace {

// Wedges that triangles join, over which texture coordinates go on without a seam: a number for each.
std::vector<std::uint32_t> label_charts(const IndexedMesh& mesh) {
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) sets.unite(t.v[0], t.v[1]), sets.unite(t.v[1], t.v[2]);
  std::vector<std::uint32_t> chart(sets.size());
  for (std::uint32_t v = 0; v < chart.size(); ++v) chart[v] = sets.find(v);
  return chart;
}

// Vertices that the maps have not seen take values from their neighbours, round by round.
void spread_sources(std::span<const Triangle> triangles, std::vector<std::uint32_t>& source) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t.v[k], b = t.v[(k + 1) % 3];
        if (source[a] == no_source && source[b] != no_source) source[a] = source[b], changed = true;
        if (source[b] == no_source && source[a] != no_source) source[b] = source[a], changed = true;
      }
  }
}

// The triangles around each vertex.
class Stars {
 public:
  Stars(std::span<const Triangle> triangles, std::size_t vertices) : first_(vertices + 1, 0) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    around_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (const std::uint32_t v : triangles[t].v) around_[next[v]++] = t;
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t v) const {
    return std::span(around_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

 private:
  std::vector<std::uint32_t> first_, around_;
};

class Resampler {
 public:
  Resampler(const IndexedMesh& from, const std::vector<std::uint32_t>& source, RawMesh& mesh)
      : from_(from), source_(source), mesh_(mesh), chart_(label_charts(from)), walk_(from.positions, from.triangles) {}

  void run() {
    CornerAttributes corners;
    const WedgeAttributes& w = from_.wedges;
    const std::size_t count = mesh_.triangles.size();
    if (!w.uv.empty()) corners.uv_of.resize(count, no_values), corners.uv.reserve(3 * count);
    if (!w.normal.empty()) corners.normal_of.resize(count, no_values), corners.normal.reserve(3 * count);
    // One material for all is not named vertex by vertex.
    std::vector<std::uint32_t> material(w.materials.empty() ? 0 : count, w.material.empty() ? 0 : no_material);
    if (!w.colour.empty()) corners.colour.resize(mesh_.positions.size());
    find_places();
    snap_to_seams();
    for (std::size_t t = 0; t < count; ++t) {
      const std::uint32_t seen = leading_source(mesh_.triangles[t].v);
      if (seen == no_source) continue;
      const std::array<SurfaceWalk::Place, 3> places = places_of(mesh_.triangles[t].v, seen);
      for (std::size_t k = 0; k < 3; ++k) {
        if (!w.uv.empty()) add_uv(corners, t, k, places[k]);
        if (!w.normal.empty()) add_normal(corners, t, k, places[k]);
      }
      if (!w.material.empty()) material[t] = w.material[from_.triangles[seen].v[0]];
    }
    for (std::uint32_t v = 0; v < corners.colour.size(); ++v) corners.colour[v] = colour_of(v);
    mesh_.wedges = make_wedges(mesh_.triangles, mesh_.positions.size(), corners);
    mesh_.wedges.material = std::move(material);
    mesh_.materials = w.materials;
    mesh_.textures = w.textures;
  }

 private:
  [[nodiscard]] std::uint32_t chart_of(std::uint32_t triangle) const { return chart_[from_.triangles[triangle].v[0]]; }

  // The triangle of the source whose chart a triangle belongs to: that of two of its corners, if two agree; those on a
  // seam are of either side.
  [[nodiscard]] std::uint32_t leading_source(const std::array<std::uint32_t, 3>& v) const {
    const auto inside = std::count_if(v.begin(), v.end(), [&](std::uint32_t corner) { return !on_seam_[corner]; });
    if (inside == 1 || inside == 2)
      return source_[*std::find_if(v.begin(), v.end(), [&](std::uint32_t corner) { return !on_seam_[corner]; })];
    const std::uint32_t first = source_[v[0]], second = source_[v[1]], third = source_[v[2]];
    if (second != no_source && third != no_source && chart_of(second) == chart_of(third)) return second;
    return first;
  }

  // Moves the nearer end of every edge that a seam crosses onto the seam, as far as the triangles around it allow: the
  // seam of the mesh then runs along that of the source, and not in teeth as wide as the samples beside it. The nearest
  // ends come first; an edge with an end on the seam is crossed no longer.
  void snap_to_seams() {
    on_seam_.assign(mesh_.positions.size(), 0);
    struct Move {
      double distance = 0;
      std::uint32_t vertex = 0, other = 0;
      Vec3d to;
      bool operator<(const Move& m) const {
        return distance != m.distance ? distance < m.distance : std::pair(vertex, other) < std::pair(m.vertex, m.other);
      }
    };
    std::vector<Move> moves;
    for (const Triangle& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t.v[k], b = t.v[(k + 1) % 3];
        if (source_[a] == no_source || source_[b] == no_source || !crosses_seam(a, b)) continue;
        for (const auto& [vertex, other] : {std::pair(a, b), std::pair(b, a)}) {
          const Vec3d p = normalised(mesh_.positions[vertex]);
          const Vec3d to = point_at(walk_.find(TriangleId(source_[other]), p));
          moves.push_back({length(to - p), vertex, other, to});
        }
      }
    if (moves.empty()) return;
    std::sort(moves.begin(), moves.end());
    const Stars stars(mesh_.triangles, mesh_.positions.size());
    for (const Move& m : moves) {
      if (on_seam_[m.vertex] || on_seam_[m.other]) continue;
      const Vec3d to = from_.transform.origin + from_.transform.scale * m.to;
      if (!may_move(stars, m.vertex, to)) continue;
      mesh_.positions[m.vertex] = to;
      on_seam_[m.vertex] = 1;
      place_[m.vertex] = walk_.find(TriangleId(source_[m.vertex]), m.to);
    }
  }

  [[nodiscard]] bool crosses_seam(std::uint32_t a, std::uint32_t b) const {
    if (chart_of(source_[a]) != chart_of(source_[b])) return true;
    return !from_.wedges.uv.empty() && jumps(a, b);
  }

  // True if the triangles around a vertex keep their direction, nearly, and a share of their area.
  [[nodiscard]] bool may_move(const Stars& stars, std::uint32_t vertex, Vec3d to) const {
    return std::ranges::all_of(stars.of(vertex), [&](std::uint32_t t) {
      const auto normal = [&](bool moved) {
        std::array<Vec3d, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = mesh_.triangles[t].v[k];
          p[k] = moved && v == vertex ? to : mesh_.positions[v];
        }
        return cross(p[1] - p[0], p[2] - p[0]);
      };
      const Vec3d before = normal(false), after = normal(true);
      return dot(before, after) > 0.94 * length(before) * length(after) && length(after) > 0.15 * length(before);
    });
  }

  void find_places() {
    place_.resize(mesh_.positions.size());
    for (std::size_t v = 0; v < place_.size(); ++v)
      if (source_[v] != no_source) place_[v] = walk_.find(TriangleId(source_[v]), normalised(mesh_.positions[v]));
  }

  // Places on the source from which the corners of such a triangle take their values: each its own place, unless a seam
  // lies between them. Then all are reached from one of them without crossing it: a chart may also touch itself.
  [[nodiscard]] std::array<SurfaceWalk::Place, 3> places_of(const std::array<std::uint32_t, 3>& v,
                                                            std::uint32_t leading) const {
    std::array<SurfaceWalk::Place, 3> places;
    bool whole = true;
    for (std::size_t k = 0; k < 3; ++k) {
      places[k] = place_[v[k]];
      whole &= source_[v[k]] != no_source && chart_of(source_[v[k]]) == chart_of(leading);
    }
    if (whole && !jumps(v)) return places;
    for (std::size_t k = 0; k < 3; ++k) {
      const SurfaceWalk::Place reached = walk_.find(TriangleId(leading), normalised(mesh_.positions[v[k]]));
      // Equal but for rounding: corners of a vertex share a wedge if they can.
      const bool same = source_[v[k]] != no_source && chart_of(source_[v[k]]) == chart_of(leading) &&
                        distance(uv_at(reached), uv_at(places[k])) < 1e-5f;
      if (!same) places[k] = reached;
    }
    return places;
  }

  // True if texture coordinates differ by far more than the surface between the corners explains.
  [[nodiscard]] bool jumps(const std::array<std::uint32_t, 3>& v) const {
    if (from_.wedges.uv.empty()) return false;
    return jumps(v[0], v[1]) || jumps(v[1], v[2]) || jumps(v[2], v[0]);
  }
  [[nodiscard]] bool jumps(std::uint32_t a, std::uint32_t b) const {
    const double length_there = length(normalised(mesh_.positions[a]) - normalised(mesh_.positions[b]));
    return distance(uv_at(place_[a]), uv_at(place_[b])) > 4 * density_at(place_[a].triangle) * length_there;
  }
  // Length in the texture over length on the surface.
  [[nodiscard]] double density_at(std::uint32_t triangle) const {
    const auto& v = from_.triangles[triangle].v;
    const Vec2f p = from_.wedges.uv[v[0]], q = from_.wedges.uv[v[1]], r = from_.wedges.uv[v[2]];
    const double there = std::abs(double{q.x - p.x} * (r.y - p.y) - double{q.y - p.y} * (r.x - p.x));
    const Vec3d a = to_double(from_.positions[v[0]]);
    const double here = length(cross(to_double(from_.positions[v[1]]) - a, to_double(from_.positions[v[2]]) - a));
    return here > 0 ? std::sqrt(there / here) : 0;
  }
  [[nodiscard]] Vec3d point_at(const SurfaceWalk::Place& place) const {
    Vec3d p;
    for (std::size_t i = 0; i < 3; ++i)
      p = p + place.share[i] * to_double(from_.positions[from_.triangles[place.triangle].v[i]]);
    return p;
  }
  [[nodiscard]] Vec2f uv_at(const SurfaceWalk::Place& place) const {
    if (from_.wedges.uv.empty()) return {};
    double u = 0, v = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2f uv = from_.wedges.uv[from_.triangles[place.triangle].v[i]];
      u += place.share[i] * uv.x, v += place.share[i] * uv.y;
    }
    return {static_cast<float>(u), static_cast<float>(v)};
  }
  [[nodiscard]] static double distance(Vec2f a, Vec2f b) { return std::hypot(double{a.x} - b.x, double{a.y} - b.y); }

  [[nodiscard]] Vec3d normalised(Vec3d p) const { return (1 / from_.transform.scale) * (p - from_.transform.origin); }

  void add_uv(CornerAttributes& corners, std::size_t t, std::size_t k, const SurfaceWalk::Place& place) const {
    corners.uv_of[t].v[k] = static_cast<std::uint32_t>(corners.uv.size());
    corners.uv.push_back(uv_at(place));
  }
  void add_normal(CornerAttributes& corners, std::size_t t, std::size_t k, const SurfaceWalk::Place& place) const {
    Vec3d n;
    for (std::size_t i = 0; i < 3; ++i)
      n = n + place.share[i] * to_double(from_.wedges.normal[from_.triangles[place.triangle].v[i]]);
    corners.normal_of[t].v[k] = static_cast<std::uint32_t>(corners.normal.size());
    corners.normal.push_back(unit_normal(n));
  }
  [[nodiscard]] Rgba8 colour_of(std::uint32_t v) const {
    if (source_[v] == no_source) return {};
    const SurfaceWalk::Place& place = place_[v];
    const Triangle& t = from_.triangles[place.triangle];
    const auto mix = [&](auto part) {
      double sum = 0;
      for (std::size_t i = 0; i < 3; ++i) sum += place.share[i] * part(from_.wedges.colour[t.v[i]]);
      return static_cast<std::uint8_t>(std::clamp(sum, 0.0, 255.0) + 0.5);
    };
    return {mix([](Rgba8 c) { return c.r; }), mix([](Rgba8 c) { return c.g; }), mix([](Rgba8 c) { return c.b; }),
            mix([](Rgba8 c) { return c.a; })};
  }

  const IndexedMesh& from_;
  const std::vector<std::uint32_t>& source_;
  RawMesh& mesh_;
  std::vector<std::uint32_t> chart_;
  SurfaceWalk walk_;
  std::vector<SurfaceWalk::Place> place_;  // of each vertex with a source
  std::vector<std::uint8_t> on_seam_;      // vertices that were moved there
};

}  // namespace

void resample_attributes(const IndexedMesh& from, std::vector<std::uint32_t> source, RawMesh& mesh) {
  const WedgeAttributes& w = from.wedges;
  if (w.uv.empty() && w.colour.empty() && w.normal.empty() && w.material.empty()) return;
  spread_sources(mesh.triangles, source);
  Resampler(from, source, mesh).run();
}

RawMesh split_wedges(const RawMesh& mesh) {
  if (mesh.wedges.corners.empty()) return mesh;
  RawMesh split = mesh;
  split.positions.assign(wedge_count(mesh), Vec3d{});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      split.positions[mesh.wedges.corners[t].v[k]] = mesh.positions[mesh.triangles[t].v[k]];
  split.triangles = mesh.wedges.corners;
  split.wedges.corners.clear();
  return split;
}

}  // namespace lodestone
