#include "core/hierarchy/construct/star_distance.h"

#include <algorithm>
#include <utility>

#include "core/base/sort_unique.h"
#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

// Larger stars are searched by a tree. Stars of scans have six triangles, the largest some thirty.
constexpr std::uint32_t largest_scanned = 64;

TriangleBvh tree_of(std::span<const Triangle> all, std::span<const Vec3f> positions,
                    std::span<const std::uint32_t> chosen) {
  std::vector<Vec3d> corners;
  std::vector<Triangle> triangles;
  for (const std::uint32_t t : chosen) {
    const auto first = static_cast<std::uint32_t>(corners.size());
    for (const std::uint32_t v : all[t].v) corners.push_back(to_double(positions[v]));
    triangles.push_back({{first, first + 1, first + 2}});
  }
  return {corners, triangles};
}

}  // namespace

void StarDistance::reset(std::span<const Triangle> triangles, std::span<const Vec3f> positions) {
  triangles_ = triangles;
  positions_ = positions;
  neighbourhoods_.clear();
  // A counting sort; first_ has the ends while the triangles are placed, last one first.
  first_.assign(positions.size() + 1, 0);
  for (const Triangle& t : triangles)
    if (!is_degenerate(t))
      for (const std::uint32_t v : t.v) ++first_[v];
  std::uint32_t sum = 0;
  for (std::uint32_t& first : first_) first = sum += first;
  incident_.resize(sum);
  for (std::size_t t = triangles.size(); t-- > 0;)
    if (!is_degenerate(triangles[t]))
      for (const std::uint32_t v : triangles[t].v) incident_[--first_[v]] = static_cast<std::uint32_t>(t);
}

bool StarDistance::is_large(VertexId vertex) const { return first_[vertex + 1] - first_[vertex] > largest_scanned; }

// Those of the stars of all vertices of the star: what search_around() looks at.
std::vector<std::uint32_t> StarDistance::triangles_near(VertexId vertex) const {
  std::vector<std::uint32_t> around, triangles;
  for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i)
    for (const std::uint32_t v : triangles_[incident_[i]].v) around.push_back(v);
  sort_unique(around);
  for (const std::uint32_t v : around)
    triangles.insert(triangles.end(), incident_.begin() + first_[v], incident_.begin() + first_[v + 1]);
  sort_unique(triangles);
  return triangles;
}

const StarDistance::Neighbourhood& StarDistance::neighbourhood(VertexId vertex) {
  const auto found = neighbourhoods_.find(vertex);
  if (found != neighbourhoods_.end()) return found->second;
  std::vector<std::uint32_t> triangles = triangles_near(vertex);
  TriangleBvh tree = tree_of(triangles_, positions_, triangles);
  return neighbourhoods_.emplace(vertex, Neighbourhood{std::move(triangles), std::move(tree)}).first->second;
}

void StarDistance::search_star(double known, const Vec3d& p, VertexId vertex, Nearest& nearest) {
  if (is_large(vertex)) {
    const Neighbourhood& around = neighbourhood(vertex);
    const TriangleBvh::Nearest found = around.tree.nearest(p);
    if (found.squared_distance < nearest.squared)
      nearest = {found.squared_distance, TriangleId(around.triangles[around.tree.triangle(found.slot)])};
    return;
  }
  for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1] && nearest.squared > known; ++i) {
    const auto& v = triangles_[incident_[i]].v;
    const double squared =
        nearest_on_triangle(p, to_double(positions_[v[0]]), to_double(positions_[v[1]]), to_double(positions_[v[2]]))
            .squared_distance;
    if (squared < nearest.squared) nearest = {squared, TriangleId(incident_[i])};
  }
}

// Searches the stars of all vertices around a triangle: a step over a notch in the border of the block, where the
// search along nearer and nearer triangles would end too early.
void StarDistance::search_around(double known, const Vec3d& p, TriangleId triangle, Nearest& nearest) {
  for (const std::uint32_t v : Triangle(triangles_[triangle]).v) {
    if (is_large(VertexId(v))) {
      search_star(known, p, VertexId(v), nearest);
      continue;
    }
    for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i)
      for (const std::uint32_t u : triangles_[incident_[i]].v) search_star(known, p, VertexId(u), nearest);
  }
}

// True if the foot of p on a triangle around `vertex` lies inside that triangle and within `known`: without a division,
// since it is true for most vertices. Not of slivers, whose normals are inaccurate (core/spatial/point_triangle.h).
bool StarDistance::is_near(double known, const Vec3d& p, VertexId vertex) const {
  constexpr double sliver_sine2 = 1e-8;
  const Vec3d centre = to_double(positions_[vertex]), o = p - centre;
  for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
    const auto& v = triangles_[incident_[i]].v;
    const std::size_t k = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
    const Vec3d a = to_double(positions_[v[k == 2 ? 0 : k + 1]]) - centre,
                b = to_double(positions_[v[k == 0 ? 2 : k - 1]]) - centre;
    const Vec3d n = cross(a, b);
    const double nn = dot(n, n), h = dot(n, o);
    if (!(nn > sliver_sine2 * dot(a, a) * dot(b, b) && h * h <= known * nn)) continue;
    const double wa = dot(cross(o, b), n), wb = dot(cross(a, o), n);
    if (wa >= 0 && wb >= 0 && wa + wb <= nn) return true;
  }
  return false;
}

double StarDistance::farther(double known, Vec3f p, VertexId vertex) {
  const Vec3d point = to_double(p);
  if (!is_large(vertex) && is_near(known, point, vertex)) return known;
  Nearest nearest{squared_length(point - to_double(positions_[vertex]))};
  if (first_[vertex] < first_[vertex + 1]) nearest.triangle = TriangleId(incident_[first_[vertex]]);
  search_star(known, point, vertex, nearest);
  // Every step is strictly nearer, so this ends.
  for (bool wide = false; nearest.squared > known && nearest.triangle != none;) {
    const double before = nearest.squared;
    if (wide) {
      search_around(known, point, nearest.triangle, nearest);
    } else {
      for (const std::uint32_t v : Triangle(triangles_[nearest.triangle]).v)
        search_star(known, point, VertexId(v), nearest);
    }
    if (nearest.squared < before) {
      wide = false;
    } else if (wide) {
      break;
    } else {
      wide = true;
    }
  }
  return std::max(known, nearest.squared);
}

}  // namespace lodestone
