// A convex polygon in space, a piece of a triangle, and how planes cut it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/spatial/point_triangle.h"

namespace lodestone {

struct ConvexPiece {
  static constexpr std::uint32_t most_corners = 12;
  std::array<Vec3d, most_corners> corner;
  std::uint32_t count = 0;

  void add(Vec3d p) { corner[count++] = p; }
  [[nodiscard]] Vec3d centre() const {
    Vec3d sum;
    for (std::uint32_t i = 0; i < count; ++i) sum = sum + corner[i];
    return (1.0 / count) * sum;
  }
  // Of a piece without corners, 0.
  [[nodiscard]] double area() const {
    Vec3d sum;
    for (std::uint32_t i = 2; i < count; ++i) sum = sum + cross(corner[i - 1] - corner[0], corner[i] - corner[0]);
    return 0.5 * length(sum);
  }
};

// The points x with dot(normal, x - origin) >= offset.
struct HalfSpace {
  Vec3d normal, origin;
  double offset = 0;
};

struct CutPiece {
  ConvexPiece inside, outside;  // without corners where nothing is
};

// Together the parts are the piece, but for rounding: they have the points on the plane in common. One corner more on
// each side at most, so that the piece may have one less than most_corners.
[[nodiscard]] inline CutPiece cut(const ConvexPiece& piece, const HalfSpace& half) {
  std::array<double, ConvexPiece::most_corners> height;
  double lowest = 0, highest = 0;
  for (std::uint32_t i = 0; i < piece.count; ++i) {
    height[i] = dot(half.normal, piece.corner[i] - half.origin) - half.offset;
    lowest = std::min(lowest, height[i]);
    highest = std::max(highest, height[i]);
  }
  if (!(lowest < 0)) return {piece, {}};
  if (!(highest > 0)) return {{}, piece};
  CutPiece parts;
  for (std::uint32_t i = 0; i < piece.count; ++i) {
    const std::uint32_t next = i + 1 < piece.count ? i + 1 : 0;
    const Vec3d a = piece.corner[i], b = piece.corner[next];
    if (height[i] >= 0) parts.inside.add(a);
    if (height[i] <= 0) parts.outside.add(a);
    if ((height[i] < 0 && height[next] > 0) || (height[i] > 0 && height[next] < 0)) {
      const Vec3d between = a + (height[i] / (height[i] - height[next])) * (b - a);
      parts.inside.add(between);
      parts.outside.add(between);
    }
  }
  return parts;
}

// Half by half across the longest distance of two corners.
[[nodiscard]] inline CutPiece halved(const ConvexPiece& piece) {
  double longest = -1;
  Vec3d from, to;
  for (std::uint32_t i = 0; i < piece.count; ++i)
    for (std::uint32_t k = i + 1; k < piece.count; ++k)
      if (const double d = squared_length(piece.corner[k] - piece.corner[i]); d > longest) {
        longest = d;
        from = piece.corner[i];
        to = piece.corner[k];
      }
  return cut(piece, {to - from, 0.5 * (from + to), 0});
}

}  // namespace lodestone
