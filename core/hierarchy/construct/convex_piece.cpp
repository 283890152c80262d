#include "core/hierarchy/construct/convex_piece.h"

#include <algorithm>
#include <cmath>

#include "core/spatial/point_triangle.h"

namespace lodestone {

ConvexPiece piece_of(const TriangleCorners& t) {
  ConvexPiece piece;
  for (const Vec3d p : t) piece.add(p);
  return piece;
}

Box3f box_of(const ConvexPiece& piece) {
  Box3f box;
  for (std::uint32_t i = 0; i < piece.count; ++i) box.extend(to_float(piece.corner[i]));
  return box;
}

double radius_of(const ConvexPiece& piece, Vec3d centre) {
  double squared = 0;
  for (std::uint32_t i = 0; i < piece.count; ++i) squared = std::max(squared, squared_length(piece.corner[i] - centre));
  return std::sqrt(squared);
}

double farthest(const ConvexPiece& piece, const TriangleCorners& t) {
  double squared = 0;
  for (std::uint32_t i = 0; i < piece.count; ++i)
    squared = std::max(squared, nearest_on_triangle(piece.corner[i], t[0], t[1], t[2]).squared_distance);
  return std::sqrt(squared);
}

CutPiece cut(const ConvexPiece& piece, const HalfSpace& half) {
  std::array<double, ConvexPiece::max_corners> height;
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

CutPiece halved(const ConvexPiece& piece) {
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
