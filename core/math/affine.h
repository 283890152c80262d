// Affine maps of space in double precision: nodes of a glTF scene, tiles of a tileset.
#pragma once

#include <array>

#include "core/math/vec3.h"

namespace lodestone {

// p -> p.x axes[0] + p.y axes[1] + p.z axes[2] + origin: the columns of a 4 x 4 matrix whose last row is (0, 0, 0, 1).
struct Affine3d {
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d origin;

  [[nodiscard]] constexpr Vec3d vector(Vec3d v) const { return v.x * axes[0] + v.y * axes[1] + v.z * axes[2]; }
  [[nodiscard]] constexpr Vec3d point(Vec3d p) const { return vector(p) + origin; }
  [[nodiscard]] constexpr double determinant() const { return dot(axes[0], cross(axes[1], axes[2])); }
  // Along the image of a normal, of any length: the cofactors are the inverse transpose times the determinant, and
  // exist for singular maps, too. Towards the same side of the surface when triangles of a mirrored mesh are turned.
  [[nodiscard]] constexpr Vec3d normal(Vec3d n) const {
    const Vec3d cofactor =
        n.x * cross(axes[1], axes[2]) + n.y * cross(axes[2], axes[0]) + n.z * cross(axes[0], axes[1]);
    return (determinant() < 0 ? -1.0 : 1.0) * cofactor;
  }
  friend constexpr bool operator==(const Affine3d&, const Affine3d&) = default;
};

// First b, then a.
[[nodiscard]] constexpr Affine3d operator*(const Affine3d& a, const Affine3d& b) {
  return {{a.vector(b.axes[0]), a.vector(b.axes[1]), a.vector(b.axes[2])}, a.point(b.origin)};
}

}  // namespace lodestone
