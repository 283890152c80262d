// Surfaces with charts and seams for the tests of progressive meshes.
#pragma once

#include "core/mesh/clean.h"
#include "core/mesh/raw_mesh.h"
#include "parallel/clean/prepare.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// A closed torus of n x m squares whose texture is one rectangle (two seams that cross), or a rectangle for each half.
inline IndexedMesh textured_torus(std::uint32_t n, std::uint32_t m, bool halves, Scheduler& scheduler) {
  const IndexedMesh plain = torus_mesh(n, m);
  RawMesh raw;
  for (const Vec3f p : plain.positions) raw.positions.push_back(to_double(p));
  raw.triangles = plain.triangles;
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i)
      for (int half = 0; half < 2; ++half) {
        const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
          const bool second = halves && i >= n / 2;
          raw.wedges.uv.push_back({static_cast<float>(i + di) / static_cast<float>(n) + (second ? 2.0f : 0.0f),
                                   static_cast<float>(j + dj) / static_cast<float>(m)});
          const float angle = 6.2831853f * static_cast<float>(i + di) / static_cast<float>(n);
          raw.wedges.normal.push_back(unit_normal({std::cos(angle), std::sin(angle), 0}));
          return static_cast<std::uint32_t>(raw.wedges.uv.size() - 1);
        };
        if (half == 0) raw.wedges.corners.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
        if (half == 1) raw.wedges.corners.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
      }
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, scheduler);
}

// Two cubes that share an edge, and a third that touches one of them in a corner; each of n^2 squares a side.
inline IndexedMesh touching_cubes(std::uint32_t n, Scheduler& scheduler) {
  RawMesh raw;
  const auto add_cube = [&](Vec3d at) {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        for (std::uint32_t i = 0; i < n; ++i)
          for (std::uint32_t j = 0; j < n; ++j) {
            const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
              double c[3];
              c[axis] = side;
              c[(axis + 1) % 3] = static_cast<double>(side == 1 ? i + di : j + dj) / n;
              c[(axis + 2) % 3] = static_cast<double>(side == 1 ? j + dj : i + di) / n;
              raw.positions.push_back(at + Vec3d{c[0], c[1], c[2]});
              return static_cast<std::uint32_t>(raw.positions.size() - 1);
            };
            const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
            raw.triangles.push_back({a, b, c});
            raw.triangles.push_back({a, c, d});
          }
  };
  add_cube({0, 0, 0});
  add_cube({1, 1, 0});
  add_cube({-1, -1, -1});
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, scheduler);
}

}  // namespace lodestone::test
