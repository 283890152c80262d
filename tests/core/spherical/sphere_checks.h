// Meshes on the unit sphere for tests, and deterministic numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/math/affine.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// Numbers in [0, 1) that are the same everywhere.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}
  double operator()() {
    state_ ^= state_ << 13, state_ ^= state_ >> 7, state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  Vec3d direction() {
    for (;;) {
      const Vec3d d{2 * (*this)() - 1, 2 * (*this)() - 1, 2 * (*this)() - 1};
      if (const double l = length(d); l > 0.1 && l < 1) return (1 / l) * d;
    }
  }
  Affine3d rotation() {
    const Vec3d x = direction(), z = cross(x, direction());
    const Vec3d unit_z = (1 / length(z)) * z;
    return {{x, cross(unit_z, x), unit_z}, {}};
  }

 private:
  std::uint64_t state_;
};

struct SphereMesh {
  std::vector<Vec3d> directions;
  std::vector<Triangle> triangles;
};

inline SphereMesh octahedron_on_sphere(int subdivisions) {
  SphereMesh mesh;
  octahedral_sphere(mesh.directions, mesh.triangles, subdivisions);
  return mesh;
}

inline SphereMesh tetrahedron_on_sphere(int subdivisions) {
  const double c = 1 / std::sqrt(3.0);
  SphereMesh mesh{{{c, c, c}, {-c, -c, c}, {-c, c, -c}, {c, -c, -c}},
                  {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}}};
  subdivide_on_sphere(mesh.directions, mesh.triangles, subdivisions);
  return mesh;
}

inline void rotate(SphereMesh& mesh, const Affine3d& rotation) {
  for (Vec3d& d : mesh.directions) {
    d = rotation.vector(d);
    d = (1 / length(d)) * d;
  }
}

}  // namespace lodestone::test
