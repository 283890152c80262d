#include "render/reconstruct/views/condense_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

struct Step {
  int dx, dy;
};
constexpr std::array<Step, 8> steps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};

// The sum of squared distances from planes through points, as seen from a first point.
class Planes {
 public:
  void add(Vec3f normal, Vec3f from_first, float weight) {
    const float d = weight * dot(normal, from_first);
    xx_ += weight * normal.x * normal.x, xy_ += weight * normal.x * normal.y, xz_ += weight * normal.x * normal.z;
    yy_ += weight * normal.y * normal.y, yz_ += weight * normal.y * normal.z, zz_ += weight * normal.z * normal.z;
    rhs_ = rhs_ + d * normal;
    weight_ += weight;
  }
  // The point of the minimum, with `stiffness` of the weight against any movement. Solved by Cramer's rule: the matrix
  // is far from singular with the stiffness.
  [[nodiscard]] Vec3f least(float stiffness) const {
    const float s = stiffness * weight_, a = xx_ + s, d = yy_ + s, f = zz_ + s;
    const float m00 = d * f - yz_ * yz_, m01 = xz_ * yz_ - xy_ * f, m02 = xy_ * yz_ - xz_ * d;
    const float m11 = a * f - xz_ * xz_, m12 = xy_ * xz_ - a * yz_, m22 = a * d - xy_ * xy_;
    const float determinant = a * m00 + xy_ * m01 + xz_ * m02;
    if (!(determinant > 0)) return {};
    const float scale = 1 / determinant;
    return {scale * (m00 * rhs_.x + m01 * rhs_.y + m02 * rhs_.z), scale * (m01 * rhs_.x + m11 * rhs_.y + m12 * rhs_.z),
            scale * (m02 * rhs_.x + m12 * rhs_.y + m22 * rhs_.z)};
  }

 private:
  float xx_ = 0, xy_ = 0, xz_ = 0, yy_ = 0, yz_ = 0, zz_ = 0, weight_ = 0;
  Vec3f rhs_;
};

std::size_t index_in(const PositionMap& map, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.view.width) + static_cast<std::size_t>(x);
}

class Condenser {
 public:
  Condenser(const PositionMap& fine, const CondenseConfig& config, CondensedMap& result)
      : fine_(fine), config_(config), result_(result) {}

  void pixel(int x, int y) const {
    const std::size_t i = index_in(result_.map, x, y), f = index_in(fine_, 2 * x, 2 * y);
    copy(f, i);
    result_.links[i] = static_cast<std::uint8_t>(
        (linked(2 * x, 2 * y, 1, 0) ? link_right : 0) | (linked(2 * x, 2 * y, 0, 1) ? link_down : 0) |
        (linked(2 * x, 2 * y, 1, 1) ? link_diagonal : 0) | (linked(2 * x + 2, 2 * y, -1, 1) ? link_across : 0));
    result_.vertex[i] = fine_.position[f];
    if (!fine_.sees(f)) return;
    result_.map.normal[i] = mean_normal(2 * x, 2 * y);
    place(i, 2 * x, 2 * y);
  }

 private:
  [[nodiscard]] bool holds(int x, int y) const {
    return x >= 0 && y >= 0 && x < fine_.view.width && y < fine_.view.height;
  }

  void copy(std::size_t from, std::size_t to) const {
    PositionMap& map = result_.map;
    map.position[to] = fine_.position[from];
    map.triangle[to] = fine_.triangle[from];
    map.depth[to] = fine_.depth[from];
    map.normal[to] = fine_.normal[from];
    if (!map.uv.empty()) map.uv[to] = fine_.uv[from];
    if (!map.colour.empty()) map.colour[to] = fine_.colour[from];
  }

  // True if the surface continues from (x, y) over the finer pixel next to it to the next one of the result.
  [[nodiscard]] bool linked(int x, int y, int dx, int dy) const {
    if (!holds(x, y) || !holds(x + 2 * dx, y + 2 * dy)) return false;
    const std::size_t a = index_in(fine_, x, y), b = index_in(fine_, x + dx, y + dy),
                      c = index_in(fine_, x + 2 * dx, y + 2 * dy);
    return fine_.sees(a) && fine_.sees(b) && fine_.sees(c) && are_connected(fine_, config_.connect, a, b, dx, dy) &&
           are_connected(fine_, config_.connect, b, c, dx, dy);
  }

  // Mean normal of the pixel and its neighbours that are not across a crease.
  [[nodiscard]] Vec3f mean_normal(int x, int y) const {
    const Vec3f own = fine_.normal[index_in(fine_, x, y)];
    Vec3f sum = 2.0f * own;
    for (const Step& s : steps) {
      if (!holds(x + s.dx, y + s.dy)) continue;
      const std::size_t i = index_in(fine_, x + s.dx, y + s.dy);
      if (fine_.sees(i) && dot(fine_.normal[i], own) > config_.crease_cosine) sum = sum + fine_.normal[i];
    }
    const float norm = length(sum);
    return norm > 0 ? (1 / norm) * sum : own;
  }

  void place(std::size_t i, int x, int y) const {
    const std::size_t own = index_in(fine_, x, y);
    const Vec3f first = fine_.position[own], normal = fine_.normal[own];
    Planes planes;
    planes.add(normal, {}, 1);
    bool feature = false;
    for (const Step& s : steps) {
      if (!holds(x + s.dx, y + s.dy)) continue;
      const std::size_t k = index_in(fine_, x + s.dx, y + s.dy);
      if (!fine_.sees(k) || !are_connected(fine_, config_.connect, own, k, s.dx, s.dy)) continue;
      planes.add(fine_.normal[k], fine_.position[k] - first, 1);
      feature |= dot(fine_.normal[k], normal) < config_.crease_cosine;
    }
    const Vec3f step = planes.least(config_.stiffness);
    const auto h = static_cast<float>(result_.map.view.spacing(fine_.depth[own]));
    const Vec3f forward = to_float(fine_.view.forward);
    const float along = dot(step, forward), aside = length(step - along * forward);
    const float scale = std::min({1.0f, config_.farthest * h / std::max(aside, 1e-30f),
                                  2 * config_.farthest * h / std::max(std::abs(along), 1e-30f)});
    result_.vertex[i] = first + scale * step;
    if (feature && scale == 1) result_.links[i] |= on_feature;
  }

  const PositionMap& fine_;
  const CondenseConfig& config_;
  CondensedMap& result_;
};

}  // namespace

MapView finer_view(const MapView& view) {
  MapView finer = view;
  finer.pixel = view.pixel / 2;
  finer.width = 2 * view.width - 1;
  finer.height = 2 * view.height - 1;
  return finer;
}

CondensedMap condensed_like(const PositionMap& fine, const MapView& view) {
  CondensedMap result;
  PositionMap& map = result.map;
  map.view = view;
  map.transform = fine.transform;
  PixelMarks marks(view.width, view.height);
  for (int y = 0; y < view.height; ++y)
    marks.add_row(0, view.width, y, [&](int x) { return fine.sees(index_in(fine, 2 * x, 2 * y)); });
  const auto groups = marks.groups();
  map.triangle = PixelArray(groups, no_triangle);
  map.position = PixelArray<Vec3f>(groups), map.depth = PixelArray<float>(groups);
  map.normal = PixelArray<Vec3f>(groups);
  if (!fine.uv.empty()) map.uv = PixelArray<Vec2f>(groups);
  if (!fine.colour.empty()) map.colour = PixelArray(groups, Rgba8{0, 0, 0, 0});
  result.links = PixelArray<std::uint8_t>(groups);
  result.vertex = PixelArray<Vec3f>(groups);
  return result;
}

void condense_rows(const PositionMap& fine, const CondenseConfig& config, int first, int last, CondensedMap& result) {
  const Condenser condenser(fine, config, result);
  const auto width = static_cast<std::size_t>(result.map.view.width);
  for (int y = first; y < last; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * width;
    result.map.groups().for_pixels(begin, begin + width,
                                   [&](std::size_t i) { condenser.pixel(static_cast<int>(i - begin), y); });
  }
}

}  // namespace lodestone
