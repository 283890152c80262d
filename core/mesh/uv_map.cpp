#include "core/mesh/uv_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {

UvMap map_of(const UvTransform& t) {
  const double c = std::cos(double{t.rotation}), s = std::sin(double{t.rotation});
  return {c * t.scale[0], s * t.scale[1], -s * t.scale[0], c * t.scale[1], t.offset[0], t.offset[1]};
}

std::optional<UvMap> map_between(const PlaneTriangle& from, const PlaneTriangle& to) {
  const double x1 = from[1][0] - from[0][0], y1 = from[1][1] - from[0][1], x2 = from[2][0] - from[0][0],
               y2 = from[2][1] - from[0][1], area = x1 * y2 - x2 * y1;
  if (area == 0) return std::nullopt;
  UvMap map{};
  for (std::size_t row = 0; row < 2; ++row) {
    const double a = to[1][row] - to[0][row], b = to[2][row] - to[0][row];
    const double along = (a * y2 - b * y1) / area, across = (b * x1 - a * x2) / area;
    map[2 * row] = along, map[2 * row + 1] = across;
    map[4 + row] = to[0][row] - along * from[0][0] - across * from[0][1];
  }
  return map;
}

std::optional<UvTransform> transform_after(const UvMap& first, const UvMap& whole) {
  if (first == whole) return UvTransform{};
  const double a = first[0], b = first[1], c = first[2], d = first[3], x = first[4], y = first[5];
  const double area = a * d - b * c;
  if (!(std::abs(area) > 0)) return std::nullopt;
  const auto row = [&](double u, double v, double move) {
    const double along = (u * d - v * c) / area, across = (v * a - u * b) / area;
    return std::array{along, across, move - along * x - across * y};
  };
  const auto top = row(whole[0], whole[1], whole[4]), bottom = row(whole[2], whole[3], whole[5]);
  const double wide = std::hypot(top[0], bottom[0]), high = std::hypot(top[1], bottom[1]);
  if (!(std::abs(top[0] * top[1] + bottom[0] * bottom[1]) <= 1e-6 * wide * high)) return std::nullopt;
  const double largest = std::max({wide, high, std::abs(top[2]), std::abs(bottom[2])});
  if (!(largest <= double{std::numeric_limits<float>::max()})) return std::nullopt;
  const double turned = top[0] * bottom[1] - top[1] * bottom[0];  // negative: mirrored
  UvTransform out;
  out.rotation = static_cast<float>(std::atan2(-bottom[0], top[0]));
  out.scale = {static_cast<float>(wide), static_cast<float>(turned < 0 ? -high : high)};
  out.offset = {static_cast<float>(top[2]), static_cast<float>(bottom[2])};
  return out;
}

}  // namespace lodestone
