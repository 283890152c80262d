#include "experiments/systems/progressive/split_forest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/sort_unique.h"
#include "core/math/vec3.h"
#include "core/progressive/mesh/activation.h"
#include "core/spatial/point_triangle.h"
#include "experiments/systems/surface/surface_distance.h"
#include "parallel/progressive/make_progressive.h"

namespace lodestone {
namespace {

constexpr double outward = 1 + 1e-9;  // for the rounding of balls

// The mesh as it becomes coarser, collapse by collapse, with the vertices of the surface that each triangle stands for.
class Replay {
 public:
  Replay(const ProgressiveMesh& mesh, std::span<const std::uint32_t> groups)
      : mesh_(mesh),
        groups_(groups),
        triangles_(mesh.triangles),
        around_(mesh.positions.size()),
        points_(mesh.triangles.size()),
        surface_(tree_of({mesh.positions, mesh.triangles})) {
    std::vector<std::uint8_t> taken(mesh.positions.size(), 0);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (is_gone(t)) continue;
      for (const std::uint32_t v : triangles_[t].v) {
        around_[groups_[v]].push_back(t);
        if (!std::exchange(taken[v], 1)) points_[t].push_back(v);
      }
    }
  }

  // The groups that vertices of a group are joined with, those of their parents included; ascending.
  [[nodiscard]] std::vector<std::uint32_t> ring(std::uint32_t begin, std::uint32_t end) const {
    std::vector<std::uint32_t> all;
    for (std::uint32_t v = begin; v < end; ++v) all.push_back(groups_[mesh_.parents[v]]);
    for (const std::uint32_t t : around_[begin]) {
      if (is_gone(t)) continue;
      for (const std::uint32_t v : triangles_[t].v)
        if (groups_[v] != begin) all.push_back(groups_[v]);
    }
    sort_unique(all);
    return all;
  }

  // Collapses a group of vertices into their parents.
  SplitForest::Missing collapse(std::uint32_t begin) {
    std::vector<std::uint32_t> fan, moved;
    for (const std::uint32_t t : std::exchange(around_[begin], {})) {
      if (is_gone(t)) continue;
      moved.insert(moved.end(), points_[t].begin(), points_[t].end());
      points_[t].clear();
      for (std::uint32_t& v : triangles_[t].v)
        if (groups_[v] == begin) v = mesh_.parents[v];
      if (is_gone(t)) continue;
      fan.push_back(t);
      around_[groups_[mesh_.parents[begin]]].push_back(t);
    }
    return fan.empty() ? take_by_parent(begin, moved) : take_by_fan(fan, moved);
  }

 private:
  [[nodiscard]] bool is_gone(std::uint32_t t) const {
    const auto& [v] = triangles_[t];
    return groups_[v[0]] == groups_[v[1]] || groups_[v[1]] == groups_[v[2]] || groups_[v[2]] == groups_[v[0]];
  }

  [[nodiscard]] std::array<Vec3d, 3> corners(std::uint32_t t) const {
    const auto& [v] = triangles_[t];
    return {to_double(mesh_.positions[v[0]]), to_double(mesh_.positions[v[1]]), to_double(mesh_.positions[v[2]])};
  }

  // Each point goes to the nearest triangle of the fan.
  SplitForest::Missing take_by_fan(const std::vector<std::uint32_t>& fan, const std::vector<std::uint32_t>& moved) {
    std::vector<std::array<Vec3d, 3>> places;
    double farthest = 0;
    Box3d box;
    for (const std::uint32_t t : fan) {
      const auto& [a, b, c] = places.emplace_back(corners(t));
      for (const Vec3d p : {a, b, c}) box.extend(p);
      const TriangleBvh::Nearest nearest = surface_.nearest((1.0 / 3) * (a + b + c), hint_);
      hint_ = nearest.slot;
      farthest = std::max(farthest, nearest.squared_distance);
    }
    for (const std::uint32_t p : moved) {
      const Vec3d at = to_double(mesh_.positions[p]);
      double least = HUGE_VAL;
      std::uint32_t owner = fan.front();
      for (std::size_t k = 0; k < fan.size(); ++k) {
        const auto& [a, b, c] = places[k];
        const double squared = nearest_on_triangle(at, a, b, c).squared_distance;
        if (squared < least) least = squared, owner = fan[k];
      }
      points_[owner].push_back(p);
      farthest = std::max(farthest, least);
      box.extend(at);
    }
    return around(box, std::sqrt(farthest));
  }

  // For places that no triangle closes, as at the end of a strip: a triangle of the parent stands for the points.
  SplitForest::Missing take_by_parent(std::uint32_t begin, const std::vector<std::uint32_t>& moved) {
    const std::uint32_t parent = mesh_.parents[begin];
    const Vec3d at = to_double(mesh_.positions[parent]);
    Box3d box{at, at};
    double farthest = 0;
    for (const std::uint32_t p : moved) {
      box.extend(to_double(mesh_.positions[p]));
      farthest = std::max(farthest, length(to_double(mesh_.positions[p]) - at));
    }
    for (const std::uint32_t t : around_[groups_[parent]])
      if (!is_gone(t)) {
        points_[t].insert(points_[t].end(), moved.begin(), moved.end());
        break;
      }
    return around(box, farthest);
  }

  [[nodiscard]] static SplitForest::Missing around(const Box3d& box, double error) {
    return {error, 0.5 * (box.lo + box.hi), 0.5 * length(box.hi - box.lo) * outward};
  }

  const ProgressiveMesh& mesh_;
  std::span<const std::uint32_t> groups_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<std::uint32_t>> around_;  // by group: triangles, gone ones too
  std::vector<std::vector<std::uint32_t>> points_;  // by triangle
  TriangleBvh surface_;
  std::uint32_t hint_ = TriangleBvh::no_hint;
};

}  // namespace

SplitForest::SplitForest(const WeldedSurface& surface, const Transform& transform, Scheduler& scheduler) {
  ProgressiveReport report;
  mesh_ = make_progressive(indexed_mesh(surface, transform), {}, scheduler, report);
  groups_ = progressive::group_starts(mesh_);
  normals_ = normals_at(surface, mesh_.positions);
  for (const std::uint32_t t : coherent_order(mesh_.positions, mesh_.triangles))
    triangles_.push_back(mesh_.triangles[t]);
  replay();
}

void SplitForest::replay() {
  Replay replay(mesh_, groups_);
  const std::uint32_t count = mesh_.vertex_count();
  missing_.resize(count);
  std::vector<std::vector<std::uint32_t>> needs(count);
  std::uint32_t end = count;
  for (std::uint32_t v = count; v-- > mesh_.base_vertices;) {
    if (groups_[v] != v) continue;
    needs[v] = replay.ring(v, end);
    missing_[v] = replay.collapse(v);
    end = v;
  }
  first_need_.push_back(0);
  for (const auto& of_one : needs) {
    needs_.insert(needs_.end(), of_one.begin(), of_one.end());
    first_need_.push_back(static_cast<std::uint32_t>(needs_.size()));
  }
}

std::vector<std::uint32_t> SplitForest::refine(Vec3d viewpoint, double reach) const {
  const std::uint32_t count = mesh_.vertex_count();
  std::vector<std::uint8_t> active(count, 0);
  for (std::uint32_t v = count; v-- > mesh_.base_vertices;) {
    if (groups_[v] != v) continue;
    const Missing& missing = missing_[v];
    if (!active[v] && missing.error * reach <= std::max(length(viewpoint - missing.centre) - missing.radius, 0.0))
      continue;
    active[v] = 1;
    for (const std::uint32_t need : needs(VertexId(v))) active[need] = 1;
  }
  std::vector<std::uint32_t> drawn_for(count);
  for (std::uint32_t v = 0; v < count; ++v)
    drawn_for[v] = v < mesh_.base_vertices || active[groups_[v]] ? v : drawn_for[mesh_.parents[v]];
  return drawn_for;
}

std::vector<Triangle> SplitForest::triangles(std::span<const std::uint32_t> drawn_for) const {
  std::vector<Triangle> drawn;
  for (const auto& [v] : triangles_) {
    const Triangle t{{drawn_for[v[0]], drawn_for[v[1]], drawn_for[v[2]]}};
    const std::uint32_t a = groups_[t.v[0]], b = groups_[t.v[1]], c = groups_[t.v[2]];
    if (a != b && b != c && c != a) drawn.push_back(t);
  }
  return drawn;
}

}  // namespace lodestone
