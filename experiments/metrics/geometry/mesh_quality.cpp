#include "experiments/metrics/geometry/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/mesh/edge_census.h"

namespace lodestone {
namespace {

// Longest edge over the height above it.
void add_shape(Vec3d a, Vec3d b, Vec3d c, MeshQuality& quality) {
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const double longest2 = std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)}), area2 = length(cross(ab, ca));
  const bool flat = !(area2 > 0);
  if (!flat) quality.worst_aspect = std::max(quality.worst_aspect, longest2 / area2);
  quality.no_area += flat;
  quality.slivers += flat || longest2 > sliver_aspect * area2;
}

class Corners {
 public:
  Corners(std::span<const Triangle> triangles, std::size_t vertices) : triangles_(triangles), first_(vertices + 1, 0) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    listed_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (const std::uint32_t v : triangles[t].v) listed_[next[v]++] = t;
  }
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t v) const {
    return std::span(listed_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

  // True if edges at v lead from any of its triangles to any other.
  [[nodiscard]] bool is_one_fan(std::uint32_t v) const {
    const auto all = around(v);
    std::vector<std::uint8_t> reached(all.size(), 0);
    std::vector<std::size_t> open{0};
    reached[0] = 1;
    std::size_t count = 1;
    while (!open.empty()) {
      const Triangle& t = triangles_[all[open.back()]];
      open.pop_back();
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (reached[k] || !share_edge(t, triangles_[all[k]], v)) continue;
        reached[k] = 1, ++count;
        open.push_back(k);
      }
    }
    return count == all.size();
  }

 private:
  static bool share_edge(const Triangle& s, const Triangle& t, std::uint32_t v) {
    return std::any_of(s.v.begin(), s.v.end(),
                       [&](std::uint32_t w) { return w != v && std::find(t.v.begin(), t.v.end(), w) != t.v.end(); });
  }
  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> first_, listed_;
};

double length_of_borders(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                         const Corners& corners) {
  double sum = 0;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t.v[k], b = t.v[(k + 1) % 3];
      const auto around = corners.around(a);
      const auto users = std::count_if(around.begin(), around.end(), [&](std::uint32_t other) {
        const auto& v = triangles[other].v;
        return std::find(v.begin(), v.end(), b) != v.end();
      });
      if (users == 1) sum += length(positions[b] - positions[a]);
    }
  return sum;
}

std::uint64_t count_components(const Corners& corners, std::span<const Triangle> triangles, std::size_t vertices) {
  DisjointSets sets(vertices);
  for (const Triangle& t : triangles) sets.unite(t.v[0], t.v[1]), sets.unite(t.v[1], t.v[2]);
  std::uint64_t count = 0;
  for (std::uint32_t v = 0; v < vertices; ++v) count += !corners.around(v).empty() && sets.find(v) == v;
  return count;
}

}  // namespace

MeshQuality measure_quality(std::span<const Vec3d> positions, std::span<const Triangle> all) {
  std::vector<Triangle> triangles;
  std::copy_if(all.begin(), all.end(), std::back_inserter(triangles),
               [](const Triangle& t) { return !is_degenerate(t); });
  MeshQuality quality;
  quality.triangles = triangles.size();
  for (const Triangle& t : triangles) add_shape(positions[t.v[0]], positions[t.v[1]], positions[t.v[2]], quality);
  const EdgeCensus census = count_edges(triangles, positions.size());
  quality.border_edges = census.border;
  quality.non_manifold_edges = census.non_manifold;
  quality.inconsistent_edges = census.inconsistent;
  const Corners corners(triangles, positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (corners.around(v).empty()) continue;
    ++quality.vertices;
    quality.non_manifold_vertices += !corners.is_one_fan(v);
  }
  quality.border_length = length_of_borders(positions, triangles, corners);
  quality.components = count_components(corners, triangles, positions.size());
  quality.euler = static_cast<std::int64_t>(quality.vertices) - static_cast<std::int64_t>(census.edges) +
                  static_cast<std::int64_t>(quality.triangles);
  return quality;
}

}  // namespace lodestone
