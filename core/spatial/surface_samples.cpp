#include "core/spatial/surface_samples.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lodestone {

SurfaceSamples::SurfaceSamples(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                               std::uint64_t area_points)
    : positions_(positions), triangles_(triangles), area_points_(area_points) {
  std::vector<char> used(positions.size(), 0);
  area_up_to_.reserve(triangles.size());
  double area = 0;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t.v) used[v] = 1;
    const Vec3d a = positions[t.v[0]], b = positions[t.v[1]], c = positions[t.v[2]];
    area += 0.5 * length(cross(b - a, c - a));
    area_up_to_.push_back(area);
  }
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) used_.push_back(v);
  if (!(area > 0)) area_points_ = 0;
}

Vec3d SurfaceSamples::point_in(const Triangle& triangle, std::uint64_t k) const {
  // Powers of the inverse of the plastic number, the root of x^3 = x + 1.
  constexpr double r1 = 0.7548776662466927, r2 = 0.5698402909980532;
  const auto fraction = [](double v) { return v - std::floor(v); };
  double u = fraction(0.5 + r1 * static_cast<double>(k)), v = fraction(0.5 + r2 * static_cast<double>(k));
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const Vec3d a = positions_[triangle.v[0]];
  return a + u * (positions_[triangle.v[1]] - a) + v * (positions_[triangle.v[2]] - a);
}

void SurfaceSamples::take(std::uint64_t begin, std::uint64_t end, std::vector<Vec3d>& out,
                          std::vector<std::uint32_t>* triangles) const {
  assert(!triangles || begin >= vertices());
  out.clear();
  if (triangles) triangles->clear();
  for (; begin < end && begin < vertices(); ++begin) out.push_back(positions_[used_[begin]]);
  if (begin >= end) return;
  const auto share = [&](std::uint64_t k) {
    return (static_cast<double>(k) + 0.5) / static_cast<double>(area_points_) * area_up_to_.back();
  };
  // The first triangle whose sum exceeds the share; the sums ascend, so the next point's triangle is not before it.
  auto at = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), share(begin - vertices()));
  for (std::uint64_t k = begin - vertices(); k < end - vertices(); ++k) {
    while (at != area_up_to_.end() && *at <= share(k)) ++at;
    if (at == area_up_to_.end()) --at;
    const auto triangle = static_cast<std::size_t>(at - area_up_to_.begin());
    out.push_back(point_in(triangles_[triangle], k));
    if (triangles) triangles->push_back(static_cast<std::uint32_t>(triangle));
  }
}

}  // namespace lodestone
