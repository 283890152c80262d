// The quality of a map to the sphere.
#pragma once

#include <cstdint>
#include <span>

#include "core/math/vec3.h"

namespace lodestone::spherical {

// Sums over triangles.
struct SphereSums {
  double area = 0;            // of the surface
  double stretch = 0;         // area times half the squared Frobenius norm of the way from the sphere to the surface
  std::uint64_t flips = 0;    // not positively oriented on the sphere, exactly
  std::uint64_t slivers = 0;  // on the sphere less than a hundredth of the longest edge high
  std::uint64_t surface_slivers = 0;  // the same on the surface

  void add(const SphereSums& other);
  // Stretch efficiency (praun2003), A^2 / (4 pi stretch): 1 if areas and angles are kept, 0 without an area. Each
  // triangle on the sphere is split at the foot of the perpendicular on its longest edge and both parts are taken as
  // flat, since a flat sliver hides the stretch of a curved one.
  [[nodiscard]] double efficiency() const;
};

// The triangles given; directions by vertex, as positions.
[[nodiscard]] SphereSums measure_sphere_map(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                            std::span<const Vec3d> directions);

}  // namespace lodestone::spherical
