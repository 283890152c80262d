#include "render/reconstruct/surface_walk.h"

#include <algorithm>
#include <numeric>

#include "core/distance/point_triangle.h"

namespace lodestone {
namespace {

constexpr std::uint32_t none = 0xFFFF'FFFFu;

// Of a point of the triangle, or one that is off it by rounding.
std::array<double, 3> shares_of(const std::array<Vec3d, 3>& c, Vec3d q) {
  const Vec3d normal = cross(c[1] - c[0], c[2] - c[0]);
  const double area2 = dot(normal, normal);
  if (!(area2 > 0)) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
  const double s = std::clamp(dot(cross(q - c[0], c[2] - c[0]), normal) / area2, 0.0, 1.0);
  const double t = std::clamp(dot(cross(c[1] - c[0], q - c[0]), normal) / area2, 0.0, 1 - s);
  return {1 - s - t, s, t};
}

}  // namespace

SurfaceWalk::SurfaceWalk(const IndexedMesh& mesh)
    : mesh_(mesh), first_(mesh.positions.size() + 1, 0), around_(3 * mesh.triangles.size()) {
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t.v) ++first_[v + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t].v) around_[next[v]++] = t;
}

SurfaceWalk::Place SurfaceWalk::find(std::uint32_t start, Vec3d point) const {
  const auto nearest_on = [&](std::uint32_t t) {
    const std::array<Vec3d, 3> c = corners(t);
    return nearest_on_triangle(point, c[0], c[1], c[2]);
  };
  std::uint32_t at = start;
  NearestPoint nearest = nearest_on(at);
  for (int steps = 0; steps < 256; ++steps) {
    std::uint32_t best = none;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const std::uint32_t other = neighbour(at, edge);
      if (other == none) continue;
      const NearestPoint there = nearest_on(other);
      if (there.squared_distance < nearest.squared_distance) nearest = there, best = other;
    }
    if (best == none) break;
    at = best;
  }
  return {at, shares_of(corners(at), nearest.point)};
}

// Over the edge from corner `edge` to the next one.
std::uint32_t SurfaceWalk::neighbour(std::uint32_t triangle, std::size_t edge) const {
  const auto& v = mesh_.triangles[triangle].v;
  const std::uint32_t a = v[edge], b = v[(edge + 1) % 3];
  for (std::uint32_t k = first_[a]; k < first_[a + 1]; ++k) {
    const auto& u = mesh_.triangles[around_[k]].v;
    if (around_[k] != triangle && (u[0] == b || u[1] == b || u[2] == b)) return around_[k];
  }
  return none;
}

std::array<Vec3d, 3> SurfaceWalk::corners(std::uint32_t triangle) const {
  const auto& v = mesh_.triangles[triangle].v;
  return {to_double(mesh_.positions[v[0]]), to_double(mesh_.positions[v[1]]), to_double(mesh_.positions[v[2]])};
}

}  // namespace lodestone
