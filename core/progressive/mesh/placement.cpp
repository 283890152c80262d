#include "core/progressive/mesh/placement.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "core/math/quadric.h"
#include "core/spatial/point_triangle.h"

namespace lodestone::progressive {
namespace {

constexpr double stiffness = 1e-3;  // where planes do not say where a vertex belongs, it remains
constexpr double min_cosine = 0.5;  // of the angle that a triangle may turn by
// Least squares may increase the mean squared distance from the planes by this factor. It keeps edges of CAD models
// sharp, which planes know and the vertices beside them do not.
constexpr double max_cost_ratio = 2;

constexpr double parabola_step = 1e-3;  // along a line costs are a parabola, which three points give

// A *site* is a vertex with its wedges, and with its copies where the surface was cut apart; its number is that of the
// first of them.
class Placer {
 public:
  Placer(const ProgressiveMesh& mesh, const LevelTopology& level)
      : mesh_(mesh),
        level_(level),
        positions_(mesh.positions.begin(), mesh.positions.begin() + level.vertices),
        fixed_(level.vertices, false),
        planes_(level.vertices),
        areas_(mesh.positions.size(), 0) {
    const WedgeAttributes& a = mesh.wedges;
    along_normals_ = !a.uv.empty() || !a.normal.empty() || !a.colour.empty();
  }

  std::vector<Vec3f> run() {
    find_sites();
    list_stars();
    fix_borders();
    add_planes();
    for_free_sites([&](std::uint32_t v) { move_to_planes(v); });
    find_pulls();
    for_free_sites([&](std::uint32_t v) { follow_pull(v); });
    for (std::uint32_t v = 0; v < level_.vertices; ++v) positions_[v] = positions_[sites_[v]];
    return std::move(positions_);
  }

 private:
  struct Pull {
    Vec3d way;
    double weight = 0;
  };

  template <class Body>
  void for_free_sites(const Body& body) {
    for (std::uint32_t v = 0; v < level_.vertices; ++v)
      if (sites_[v] == v && !fixed_[v]) body(v);
  }

  // Vertices of several wedges are fixed.
  void find_sites() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t v = 0; v < level_.vertices; ++v)
      if (level_.groups[v] == v) order.push_back(v);
    const auto key = [&](std::uint32_t v) { return std::tuple(positions_[v].x, positions_[v].y, positions_[v].z, v); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    sites_.assign(level_.groups.begin(), level_.groups.begin() + level_.vertices);
    for (std::size_t k = 1; k < order.size(); ++k)
      if (positions_[order[k - 1]] == positions_[order[k]]) sites_[order[k]] = sites_[order[k - 1]];
    for (std::uint32_t v = 0; v < level_.vertices; ++v) {
      sites_[v] = sites_[level_.groups[v]];
      if (level_.groups[v] != v) fixed_[sites_[v]] = true;
    }
  }

  // The triangles around each site.
  void list_stars() {
    star_begin_.assign(level_.vertices + 1, 0);
    for (const Triangle& t : level_.triangles)
      for (const std::uint32_t v : t.v) ++star_begin_[sites_[v] + 1];
    for (std::size_t k = 1; k < star_begin_.size(); ++k) star_begin_[k] += star_begin_[k - 1];
    stars_.resize(star_begin_.back());
    std::vector<std::uint32_t> fill(star_begin_.begin(), star_begin_.end() - 1);
    for (std::uint32_t t = 0; t < level_.triangles.size(); ++t)
      for (const std::uint32_t v : level_.triangles[t].v) stars_[fill[sites_[v]]++] = t;
  }
  [[nodiscard]] std::span<const std::uint32_t> star(std::uint32_t site) const {
    return std::span(stars_).subspan(star_begin_[site], star_begin_[site + 1] - star_begin_[site]);
  }
  // The other two corners of a triangle of a star.
  [[nodiscard]] std::array<std::uint32_t, 2> others(std::uint32_t triangle, std::uint32_t site) const {
    const Triangle& t = level_.triangles[triangle];
    const std::size_t k = sites_[t.v[0]] == site ? 0 : sites_[t.v[1]] == site ? 1 : 2;
    return {sites_[t.v[(k + 1) % 3]], sites_[t.v[(k + 2) % 3]]};
  }

  // A site is on a border if one of its edges has a single triangle.
  void fix_borders() {
    std::vector<std::uint32_t> around;
    for_free_sites([&](std::uint32_t v) {
      around.clear();
      for (const std::uint32_t t : star(v))
        for (const std::uint32_t x : others(t, v)) around.push_back(x);
      std::sort(around.begin(), around.end());
      fixed_[v] = around.empty();
      for (auto at = around.begin(); at != around.end() && !fixed_[v];) {
        const auto next = std::upper_bound(at, around.end(), *at);
        fixed_[v] = next - at < 2;
        at = next;
      }
    });
  }

  // Those of every finest triangle, to the vertices that its corners have collapsed into.
  void add_planes() {
    for (const Triangle& t : mesh_.triangles) {
      const auto p = [&](std::size_t k) { return to_double(mesh_.positions[t.v[k]]); };
      const Vec3d normal = cross(p(1) - p(0), p(2) - p(0));
      const double size = length(normal);
      if (!(size > 0)) continue;
      for (const std::uint32_t v : t.v) {
        areas_[v] += static_cast<float>(size);
        planes_[sites_[level_.ancestors[v]]].add_plane(1 / size * normal, p(0), size);
      }
    }
  }

  [[nodiscard]] Vec3d at(std::uint32_t site) const { return to_double(positions_[site]); }

  // The mean normal of the triangles around the site; zero if they have none.
  [[nodiscard]] Vec3d normal(std::uint32_t v) const {
    Vec3d sum;
    for (const std::uint32_t t : star(v)) {
      const auto [a, b] = others(t, v);
      sum = sum + cross(at(a) - at(v), at(b) - at(v));
    }
    const double size = length(sum);
    return size > 0 ? 1 / size * sum : Vec3d{};
  }

  [[nodiscard]] Vec3d nearest_to_planes(std::uint32_t v) const {
    const Quadric& q = planes_[v];
    if (!along_normals_) return q.minimum_near(at(v), stiffness);
    const Vec3d step = parabola_step * normal(v);
    const double here = q.cost(at(v)), above = q.cost(at(v) + step), below = q.cost(at(v) - step);
    const double bend = above + below - 2 * here;
    return bend > 0 ? at(v) + (below - above) / (2 * bend) * step : at(v);
  }

  // At most as far as the longest edge: beyond that the minimum says nothing about this star.
  void move_to_planes(std::uint32_t v) {
    const Vec3d to = nearest_to_planes(v);
    double longest = 0;
    for (const std::uint32_t t : star(v))
      for (const std::uint32_t x : others(t, v)) longest = std::max(longest, length(at(x) - at(v)));
    if (length(to - at(v)) <= longest && !turns(v, to)) positions_[v] = to_float(to);
  }

  // Every vertex of the finest level pulls at the corners of the triangle next to it, of those around its ancestor.
  void find_pulls() {
    pulls_.assign(level_.vertices, {});
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) {
      const Vec3d p = to_double(mesh_.positions[v]);
      NearestPoint nearest{p, std::numeric_limits<double>::infinity()};
      std::array<Vec3d, 3> corners;
      const Triangle* below = nullptr;
      for (const std::uint32_t t : star(sites_[level_.ancestors[v]])) {
        const Triangle& triangle = level_.triangles[t];
        const std::array<Vec3d, 3> c{at(sites_[triangle.v[0]]), at(sites_[triangle.v[1]]), at(sites_[triangle.v[2]])};
        const NearestPoint here = nearest_on_triangle(p, c[0], c[1], c[2]);
        if (here.squared_distance < nearest.squared_distance) nearest = here, corners = c, below = &triangle;
      }
      if (below == nullptr) continue;
      const std::array<double, 3> shares = barycentric(nearest.point, corners[0], corners[1], corners[2]);
      for (std::size_t k = 0; k < 3; ++k) {
        Pull& pull = pulls_[sites_[below->v[k]]];
        const double weight = areas_[v] * std::max(shares[k], 0.0);
        pull.way = pull.way + weight * (p - nearest.point);
        pull.weight += weight;
      }
    }
  }

  void follow_pull(std::uint32_t v) {
    const Pull& pull = pulls_[v];
    if (!(pull.weight > 0)) return;
    Vec3d way = 1 / pull.weight * pull.way;
    if (along_normals_) way = dot(way, normal(v)) * normal(v);
    const Vec3d to = at(v) + way;
    if (planes_[v].cost(to) <= max_cost_ratio * planes_[v].cost(at(v)) && !turns(v, to)) positions_[v] = to_float(to);
  }

  [[nodiscard]] bool turns(std::uint32_t v, Vec3d to) const {
    const Vec3d from = at(v);
    for (const std::uint32_t t : star(v)) {
      const auto [first, second] = others(t, v);
      const Vec3d a = at(first), b = at(second), before = cross(a - from, b - from), after = cross(a - to, b - to);
      const double size = length(before);
      if (size > 0 && !(dot(before, after) > min_cosine * size * length(after))) return true;
    }
    return false;
  }

  const ProgressiveMesh& mesh_;
  const LevelTopology& level_;
  std::vector<Vec3f> positions_;
  std::vector<std::uint32_t> sites_, star_begin_, stars_;
  bool along_normals_ = false;
  std::vector<bool> fixed_;      // by site
  std::vector<Quadric> planes_;  // likewise
  std::vector<float> areas_;     // by vertex of the finest level: twice that of its triangles
  std::vector<Pull> pulls_;      // by site
};

}  // namespace

std::vector<Vec3f> place_level(const ProgressiveMesh& mesh, const LevelTopology& level) {
  return Placer(mesh, level).run();
}

}  // namespace lodestone::progressive
