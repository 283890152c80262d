#include "render/reconstruct/finish/surface_walk.h"

#include <algorithm>
#include <numeric>

#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

// Weights of a point of the triangle, or of one that is off it by rounding.
std::array<double, 3> shares_of(const std::array<Vec3d, 3>& c, Vec3d q) {
  const Vec3d normal = cross(c[1] - c[0], c[2] - c[0]);
  const double area2 = dot(normal, normal);
  if (!(area2 > 0)) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
  const double s = std::clamp(dot(cross(q - c[0], c[2] - c[0]), normal) / area2, 0.0, 1.0);
  const double t = std::clamp(dot(cross(c[1] - c[0], q - c[0]), normal) / area2, 0.0, 1 - s);
  return {1 - s - t, s, t};
}

}  // namespace

SurfaceWalk::SurfaceWalk(std::span<const Vec3f> positions, std::span<const Triangle> triangles)
    : positions_(positions), triangles_(triangles), first_(positions.size() + 1, 0), around_(3 * triangles.size()) {
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) ++first_[v + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (TriangleId t{0}; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t].v) around_[next[v]++] = t;
}

SurfaceWalk::Place SurfaceWalk::find(TriangleId start, Vec3d point) const {
  const auto nearest_on = [&](TriangleId t) {
    const std::array<Vec3d, 3> c = corners(t);
    return nearest_on_triangle(point, c[0], c[1], c[2]);
  };
  TriangleId at = start;
  NearestPoint nearest = nearest_on(at);
  for (int steps = 0; steps < 256; ++steps) {
    const std::array<double, 3> share = shares_of(corners(at), nearest.point);
    if (*std::min_element(share.begin(), share.end()) > 1e-6) break;  // no neighbour is nearer than a point inside
    const TriangleId before = at;
    for (const std::uint32_t v : triangles_[before].v)
      for (std::uint32_t k = first_[v]; k < first_[v + 1]; ++k) {
        const NearestPoint there = nearest_on(around_[k]);
        if (there.squared_distance < nearest.squared_distance) nearest = there, at = around_[k];
      }
    if (at == before) break;
  }
  return {at, shares_of(corners(at), nearest.point)};
}

std::array<Vec3d, 3> SurfaceWalk::corners(TriangleId triangle) const {
  const auto& v = triangles_[triangle].v;
  return {to_double(positions_[v[0]]), to_double(positions_[v[1]]), to_double(positions_[v[2]])};
}

}  // namespace lodestone
