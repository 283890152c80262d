#include "core/mesh/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

Vec3d unit_or_zero(Vec3d v) {
  const double size = length(v);
  return size > 0 ? (1 / size) * v : Vec3d{};
}
Vec3d in_plane_of(Vec3d normal, Vec3d v) { return unit_or_zero(v - dot(normal, v) * normal); }

Vec3d any_perpendicular(Vec3d normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  return in_plane_of(normal, x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
}

double angle_between(Vec3d a, Vec3d b) { return std::acos(std::clamp(dot(a, b), -1.0, 1.0)); }

float rounded(double v) { return static_cast<float>(std::floor(v * 1024 + 0.5) / 1024); }

struct TangentSum {
  Vec3d along_u;
  double unmirrored = 0;  // weight, less that of mirrored triangles
};

}  // namespace

std::vector<Tangent> tangents_of(std::span<const Triangle> triangles, std::span<const Vec3f> positions,
                                 std::span<const Vec2f> uv, std::span<const Vec3f> normals) {
  std::vector<TangentSum> sums(positions.size());
  for (const Triangle& t : triangles) {
    const auto at = [&](std::size_t k) { return to_double(positions[t.v[k % 3]]); };
    const Vec2f p = uv[t.v[0]], q = uv[t.v[1]], r = uv[t.v[2]];
    const double bu = double{q.x} - p.x, bv = double{q.y} - p.y, cu = double{r.x} - p.x, cv = double{r.y} - p.y;
    const double area = bu * cv - cu * bv;
    if (area == 0) continue;
    // v runs down: counter-clockwise triangles turn the other way in texture coordinates.
    const double turn = area < 0 ? 1 : -1;
    const Vec3d to_u = -turn * (cv * (at(1) - at(0)) - bv * (at(2) - at(0)));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d normal = to_double(normals[t.v[k]]);
      const double weight =
          angle_between(in_plane_of(normal, at(k + 1) - at(k)), in_plane_of(normal, at(k + 2) - at(k)));
      TangentSum& sum = sums[t.v[k]];
      sum.along_u = sum.along_u + weight * in_plane_of(normal, to_u);
      sum.unmirrored += weight * turn;
    }
  }
  std::vector<Tangent> tangents;
  tangents.reserve(sums.size());
  for (std::size_t w = 0; w < sums.size(); ++w) {
    Vec3d t = unit_or_zero(sums[w].along_u);
    if (t == Vec3d{}) t = any_perpendicular(to_double(normals[w]));
    tangents.push_back({{rounded(t.x), rounded(t.y), rounded(t.z)}, sums[w].unmirrored < 0 ? -1.0f : 1.0f});
  }
  return tangents;
}

}  // namespace lodestone
