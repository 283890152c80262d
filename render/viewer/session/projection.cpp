#include "render/viewer/session/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

namespace lodestone::viewer {
namespace {

glm::dmat4 to_glm(const ViewProjection& vp) {
  glm::dmat4 m;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) m[column][row] = vp.m[static_cast<std::size_t>(4 * row + column)];
  return m;
}

// Corner k of a box: bit 0 says x, bit 1 y, bit 2 z. Edges join corners that differ in one bit.
constexpr std::array<std::array<int, 2>, 12> cube_edges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

// Appends the part of an edge, in clip space, that lies in front of the near plane.
void add_line(glm::dvec4 a, glm::dvec4 b, ImageSize size, Vec3f colour, std::vector<Line>& lines) {
  const double before_a = a.z + a.w, before_b = b.z + b.w;  // both at least 0 in front of the near plane
  if (!(before_a > 0) && !(before_b > 0)) return;
  if (!(before_a > 0)) a += (before_a / (before_a - before_b)) * (b - a);
  if (!(before_b > 0)) b += (before_b / (before_b - before_a)) * (a - b);
  if (!(a.w > 0) || !(b.w > 0)) return;
  const auto x = [&](glm::dvec4 p) { return static_cast<float>((p.x / p.w + 1) * 0.5 * size.width); };
  const auto y = [&](glm::dvec4 p) { return static_cast<float>((1 - p.y / p.w) * 0.5 * size.height); };
  const Line line{x(a), y(a), x(b), y(b), static_cast<float>(1 / std::min(a.w, b.w)), colour};
  // Coordinates are limited to the fixed point of the code that draws them.
  constexpr float far_away = 1e6f;
  for (const float v : {line.x0, line.y0, line.x1, line.y1})
    if (!(std::abs(v) < far_away)) return;
  lines.push_back(line);
}

void add_cube(const std::array<glm::dvec4, 8>& corners, ImageSize size, Vec3f colour, std::vector<Line>& lines) {
  for (const auto& [from, to] : cube_edges)
    add_line(corners[static_cast<std::size_t>(from)], corners[static_cast<std::size_t>(to)], size, colour, lines);
}

}  // namespace

Unprojection::Unprojection(const ViewProjection& vp, ImageSize size) : size_(size) {
  const glm::dmat4 inverse = glm::inverse(to_glm(vp));
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      inverse_[static_cast<std::size_t>(4 * row + column)] = inverse[column][row];
}

Vec3d Unprojection::operator()(double x, double y, double depth) const {
  const std::array<double, 4> clip{2 * x / size_.width - 1, 1 - 2 * y / size_.height, 2 * depth - 1, 1};
  std::array<double, 4> p{};
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t k = 0; k < 4; ++k) p[row] += inverse_[4 * row + k] * clip[k];
  return {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

std::optional<Vec3f> project(const ViewProjection& vp, ImageSize size, Vec3d point) {
  const glm::dvec4 p = to_glm(vp) * glm::dvec4(point.x, point.y, point.z, 1);
  if (!(p.w > 0) || !(p.z + p.w > 0)) return {};
  return Vec3f{static_cast<float>((p.x / p.w + 1) * 0.5 * size.width),
               static_cast<float>((1 - p.y / p.w) * 0.5 * size.height), static_cast<float>((p.z / p.w + 1) * 0.5)};
}

void project_box(const ViewProjection& vp, ImageSize size, const Box3f& box, Vec3f colour, std::vector<Line>& lines) {
  const glm::dmat4 m = to_glm(vp);
  std::array<glm::dvec4, 8> corners;
  for (std::size_t k = 0; k < 8; ++k)
    corners[k] =
        m * glm::dvec4(k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y, k & 4 ? box.hi.z : box.lo.z, 1);
  add_cube(corners, size, colour, lines);
}

void project_frustum(const ViewProjection& vp, ImageSize size, const ViewProjection& seen, std::vector<Line>& lines) {
  const glm::dmat4 m = to_glm(vp), back = glm::inverse(to_glm(seen));
  std::array<glm::dvec4, 8> corners;
  for (std::size_t k = 0; k < 8; ++k) {
    const glm::dvec4 p = back * glm::dvec4(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1, 1);
    corners[k] = m * (p / p.w);
  }
  add_cube(corners, size, Vec3f{1, 1, 1}, lines);
}

void normalise_nearness(std::span<Line> lines) {
  float most = 0;
  for (const Line& line : lines) most = std::max(most, line.nearness);
  for (Line& line : lines) line.nearness = most > 0 ? line.nearness / most : 1;
}

}  // namespace lodestone::viewer
