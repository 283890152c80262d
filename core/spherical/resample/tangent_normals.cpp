#include "core/spherical/resample/tangent_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/spherical/octahedron/octahedral_image.h"
#include "core/texture/chart_cover.h"

namespace lodestone::spherical {
namespace {

Vec3d unit_or_zero(Vec3d v) {
  const double size = length(v);
  return size > 0 ? (1 / size) * v : Vec3d{};
}

Vec3d vector_at(const LinearImage& image, SquarePoint p) {
  const std::array<float, 4> v = sample(image, p);
  return {v[0], v[1], v[2]};
}

// As graphics hardware samples a texture that is clamped: not symmetric, unlike sample().
Vec3d clamped_at(const LinearImage& image, SquarePoint p) {
  const auto n = static_cast<std::int64_t>(image.size.width);
  const auto inside = [n](double v) {
    return std::clamp(v * static_cast<double>(n), 0.5, static_cast<double>(n) - 0.5);
  };
  return vector_at(image, {inside(p.s) / static_cast<double>(n), inside(p.t) / static_cast<double>(n)});
}

SquarePoint point_of(const FramedMesh& mesh, const Triangle& t, const std::array<double, 3>& weight) {
  SquarePoint p;
  for (std::size_t k = 0; k < 3; ++k)
    p.s += weight[k] * double{mesh.uv[t.v[k]].x}, p.t += weight[k] * double{mesh.uv[t.v[k]].y};
  return p;
}

// A triangle in the square, to be asked for the weights of its corners.
class SquareTriangle {
 public:
  SquareTriangle(const FramedMesh& mesh, const Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) corner_[k] = {mesh.uv[t.v[k]].x, mesh.uv[t.v[k]].y};
    area_ = area(corner_[0], corner_[1], corner_[2]);
  }
  // Empty if the point is outside.
  [[nodiscard]] std::optional<std::array<double, 3>> weights(SquarePoint p) const {
    if (area_ == 0) return {};
    std::array<double, 3> w{};
    for (std::size_t k = 0; k < 3; ++k) {
      w[k] = area(p, corner_[(k + 1) % 3], corner_[(k + 2) % 3]) / area_;
      if (!(w[k] >= 0)) return {};
    }
    return w;
  }
  [[nodiscard]] std::array<double, 2> range(double SquarePoint::*axis) const {
    const auto [low, high] = std::minmax({corner_[0].*axis, corner_[1].*axis, corner_[2].*axis});
    return {low, high};
  }

 private:
  static double area(SquarePoint a, SquarePoint b, SquarePoint c) {
    return (b.s - a.s) * (c.t - a.t) - (c.s - a.s) * (b.t - a.t);
  }
  std::array<SquarePoint, 3> corner_;
  double area_ = 0;
};

// Pixels along one axis: centres, but the first and the last at the sides.
struct PixelAxis {
  std::uint32_t n = 0;
  [[nodiscard]] double place(std::uint32_t i) const { return i == 0 ? 0 : i == n - 1 ? 1 : (i + 0.5) / n; }
  // Those whose places may be in a range.
  [[nodiscard]] std::uint32_t first(double low) const { return index(std::floor(low * n - 0.5)); }
  [[nodiscard]] std::uint32_t last(double high) const { return index(std::ceil(high * n - 0.5)); }

 private:
  [[nodiscard]] std::uint32_t index(double i) const {
    return static_cast<std::uint32_t>(std::clamp(i, 0.0, static_cast<double>(n - 1)));
  }
};

Vec3d in_tangent_space(const TangentFrame& frame, Vec3d object) {
  Vec3d n = unit_or_zero(frame.to_tangent(object));
  n.z = std::max(n.z, 0.0);
  n = unit_or_zero(n);
  return n == Vec3d{} ? Vec3d{0, 0, 1} : n;
}

void fill(LinearImage& image, std::vector<std::uint8_t>& covered) {
  if (std::ranges::count(covered, 1) == 0) return;
  const auto n = static_cast<std::int64_t>(image.size.width);
  const auto index = [n](std::int64_t x, std::int64_t y) {
    return std::clamp<std::int64_t>(y, 0, n - 1) * n + std::clamp<std::int64_t>(x, 0, n - 1);
  };
  extend_cover(covered, image.size, covered.size(), index, [&](std::span<const std::size_t> from, std::size_t to) {
    for (std::size_t c = 0; c < 3; ++c) {
      float sum = 0;
      for (const std::size_t pixel : from) sum += image.values[3 * pixel + c];
      image.values[3 * to + c] = sum / static_cast<float>(from.size());
    }
  });
}

}  // namespace

Vec3d TangentFrame::to_tangent(Vec3d n) const {
  // Cramer's rule; the sign of the determinant counts.
  const Vec3d across = cross(up, normal);
  const double sign = dot(along_u, across) < 0 ? -1 : 1;
  return {sign * dot(n, across), sign * dot(n, cross(normal, along_u)), sign * dot(n, cross(along_u, up))};
}

TangentFrame frame_at(const FramedMesh& mesh, const Triangle& triangle, const std::array<double, 3>& weight) {
  TangentFrame frame;
  for (std::size_t k = 0; k < 3; ++k) {
    const Tangent& tangent = mesh.tangents[triangle.v[k]];
    const Vec3d normal = to_double(mesh.normals[triangle.v[k]]), along = to_double(tangent.along_u);
    frame.normal = frame.normal + weight[k] * normal;
    frame.along_u = frame.along_u + weight[k] * along;
    frame.up = frame.up + (weight[k] * double{tangent.side}) * cross(normal, along);
  }
  return {unit_or_zero(frame.along_u), unit_or_zero(frame.up), unit_or_zero(frame.normal)};
}

LinearImage tangent_normals(const FramedMesh& mesh, const LinearImage& object, std::uint32_t size) {
  LinearImage map{{size, size}, 3, std::vector<float>(3 * std::size_t{size} * size)};
  for (std::size_t i = 2; i < map.values.size(); i += 3) map.values[i] = 1;
  std::vector<std::uint8_t> covered(std::size_t{size} * size);
  const PixelAxis axis{size};
  for (const Triangle& t : mesh.triangles) {
    const SquareTriangle triangle(mesh, t);
    const auto across = triangle.range(&SquarePoint::s), down = triangle.range(&SquarePoint::t);
    for (std::uint32_t y = axis.first(down[0]); y <= axis.last(down[1]); ++y)
      for (std::uint32_t x = axis.first(across[0]); x <= axis.last(across[1]); ++x) {
        const std::size_t pixel = std::size_t{y} * size + x;
        const SquarePoint p{axis.place(x), axis.place(y)};
        if (covered[pixel] != 0) continue;
        const auto weight = triangle.weights(p);
        if (!weight) continue;
        const Vec3f n = to_float(in_tangent_space(frame_at(mesh, t, *weight), vector_at(object, p)));
        covered[pixel] = 1;
        map.values[3 * pixel] = n.x, map.values[3 * pixel + 1] = n.y, map.values[3 * pixel + 2] = n.z;
      }
  }
  fill(map, covered);
  return map;
}

double shown_angle(const FramedMesh& mesh, const Triangle& triangle, const std::array<double, 3>& weight,
                   const LinearImage& map, const LinearImage& object) {
  const SquarePoint p = point_of(mesh, triangle, weight);
  const TangentFrame frame = frame_at(mesh, triangle, weight);
  const Vec3d shown = map.values.empty() ? frame.normal : unit_or_zero(frame.to_object(clamped_at(map, p)));
  const Vec3d difference = shown - unit_or_zero(vector_at(object, p));
  return 2 * std::asin(std::min(0.5 * length(difference), 1.0)) * (180 / std::numbers::pi);
}

}  // namespace lodestone::spherical
