// A convex polygon in space, a piece of a triangle, and its cuts by planes.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/vec3.h"

namespace lodestone {

using TriangleCorners = std::array<Vec3d, 3>;

// A convex polygon in space.
struct ConvexPiece {
  static constexpr std::uint32_t max_corners = 12;
  std::array<Vec3d, max_corners> corner;
  std::uint32_t count = 0;

  void add(Vec3d p) { corner[count++] = p; }
  [[nodiscard]] Vec3d centre() const {
    Vec3d sum;
    for (std::uint32_t i = 0; i < count; ++i) sum = sum + corner[i];
    return (1.0 / count) * sum;
  }
  // 0 without corners.
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
  ConvexPiece inside, outside;  // without corners if empty
};

[[nodiscard]] ConvexPiece piece_of(const TriangleCorners& t);
[[nodiscard]] Box3f box_of(const ConvexPiece& piece);
[[nodiscard]] double radius_of(const ConvexPiece& piece, Vec3d centre);
// Largest distance of a point of the piece from the triangle: at a corner, since the distance is convex.
[[nodiscard]] double farthest(const ConvexPiece& piece, const TriangleCorners& t);

// Except for rounding, the union of the parts is the piece: they share the points on the plane. Each part has at most
// one corner more, so that the piece may have at most max_corners - 1.
[[nodiscard]] CutPiece cut(const ConvexPiece& piece, const HalfSpace& half);
// Cuts the piece in the middle between its two farthest corners.
[[nodiscard]] CutPiece halved(const ConvexPiece& piece);

}  // namespace lodestone
