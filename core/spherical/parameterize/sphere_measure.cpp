#include "core/spherical/parameterize/sphere_measure.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "core/math/orientation.h"
#include "core/spatial/point_triangle.h"

namespace lodestone::spherical {
namespace {

using Corners = std::array<Vec3d, 3>;

double area(const Corners& c) { return length(cross(c[1] - c[0], c[2] - c[0])) / 2; }

// Area of the surface times half the trace of J^T J, for the linear map from a flat triangle to one of the surface.
double flat_stretch(const Corners& surface, const Corners& flat) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &p = surface[k], &q = surface[(k + 1) % 3], &r = surface[(k + 2) % 3];
    sum += dot(q - p, r - p) * squared_length(flat[(k + 1) % 3] - flat[(k + 2) % 3]);
  }
  const double size = area(flat), on_surface = area(surface);
  if (on_surface == 0) return 0;
  return size > 0 ? on_surface * sum / (8 * size * size) : std::numeric_limits<double>::infinity();
}

// The corners in an order that leaves the one opposite the longest edge last.
std::array<std::size_t, 3> longest_first(const Corners& c) {
  std::size_t last = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (squared_length(c[(k + 1) % 3] - c[(k + 2) % 3]) > squared_length(c[(last + 1) % 3] - c[(last + 2) % 3]))
      last = k;
  return {(last + 1) % 3, (last + 2) % 3, last};
}

double split_stretch(const Corners& surface, const Corners& sphere) {
  const auto [i, j, k] = longest_first(sphere);
  const Vec3d a = sphere[i], b = sphere[j], c = sphere[k], normal = cross(a, b);
  // The foot s a + t b has s, t >= 0 as long as the edge is the longest and shorter than a quarter turn.
  const Vec3d foot = c - (dot(c, normal) / squared_length(normal)) * normal;
  const double s = dot(cross(foot, b), normal), t = dot(cross(a, foot), normal);
  const bool inside = s > 0 && t > 0 && squared_length(foot) > 0;
  if (!inside) return flat_stretch(surface, sphere);
  const Vec3d on_sphere = (1 / length(foot)) * foot;
  const Vec3d on_surface = (1 / (s + t)) * (s * surface[i] + t * surface[j]);
  return flat_stretch({surface[i], on_surface, surface[k]}, {a, on_sphere, c}) +
         flat_stretch({on_surface, surface[j], surface[k]}, {on_sphere, b, c});
}

bool is_sliver(const Corners& c) {
  constexpr double least = 0.01;
  const auto [i, j, k] = longest_first(c);
  return 2 * area(c) < least * squared_length(c[i] - c[j]);
}

}  // namespace

void SphereSums::add(const SphereSums& other) {
  area += other.area;
  stretch += other.stretch;
  flips += other.flips;
  slivers += other.slivers;
  surface_slivers += other.surface_slivers;
}

double SphereSums::efficiency() const { return stretch > 0 ? area * area / (4 * std::numbers::pi * stretch) : 0; }

SphereSums measure_sphere_map(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                              std::span<const Vec3d> directions) {
  SphereSums sums;
  for (const Triangle& t : triangles) {
    const Corners surface{positions[t.v[0]], positions[t.v[1]], positions[t.v[2]]};
    const Corners sphere{directions[t.v[0]], directions[t.v[1]], directions[t.v[2]]};
    sums.area += area(surface);
    sums.stretch += split_stretch(surface, sphere);
    sums.flips += orientation(sphere[0], sphere[1], sphere[2]) <= 0 ? 1 : 0;
    sums.slivers += is_sliver(sphere) ? 1 : 0;
    sums.surface_slivers += is_sliver(surface) ? 1 : 0;
  }
  return sums;
}

}  // namespace lodestone::spherical
