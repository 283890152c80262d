// Closed surfaces of genus 0 for tests of the map to the sphere, pleasant and otherwise.
#pragma once

#include <cmath>
#include <random>

#include "core/mesh/generate.h"

namespace lodestone::test {

inline RawMesh bumpy_sphere(std::uint64_t triangles) { return generate_mesh({Shape::sphere, triangles, 1}); }

template <class Change>
RawMesh changed_sphere(std::uint64_t triangles, Change change) {
  RawMesh mesh = bumpy_sphere(triangles);
  for (Vec3d& p : mesh.positions) p = change(p);
  return mesh;
}

inline RawMesh stretched_ball(std::uint64_t triangles, double factor) {
  return changed_sphere(triangles, [=](Vec3d p) {
    const Vec3d q = (1 / length(p)) * p;
    return Vec3d{q.x, q.y, factor * q.z};
  });
}

inline RawMesh tetrahedron() {
  RawMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{0, 3, 2}}};
  return mesh;
}

// Two vertices of n triangles each.
inline RawMesh bipyramid(std::uint32_t n) {
  RawMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    mesh.positions.push_back({std::cos(6.283185307 * i / n), std::sin(6.283185307 * i / n), 0});
  mesh.positions.push_back({0, 0, 1}), mesh.positions.push_back({0, 0, -1});
  for (std::uint32_t i = 0; i < n; ++i) {
    mesh.triangles.push_back({{i, (i + 1) % n, n}});
    mesh.triangles.push_back({{(i + 1) % n, i, n + 1}});
  }
  return mesh;
}

// Triangles split into three, `splits` times: any of them, or always the last one, which shrinks to nothing.
inline RawMesh stacked_tetrahedra(std::uint32_t splits, bool always_the_last) {
  RawMesh mesh = tetrahedron();
  std::mt19937 random(3);
  for (std::uint32_t k = 0; k < splits; ++k) {
    const std::size_t at = always_the_last ? mesh.triangles.size() - 1 : random() % mesh.triangles.size();
    const auto [a, b, c] = mesh.triangles[at].v;
    const auto v = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back((1.0 / 3) * (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]));
    mesh.triangles[at] = {{a, b, v}};
    mesh.triangles.push_back({{b, c, v}});
    mesh.triangles.push_back({{c, a, v}});
  }
  return mesh;
}

// A prism over a triangle, n rings long.
inline RawMesh thin_tube(std::uint32_t n) {
  RawMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) mesh.positions.push_back({std::cos(2.0944 * k), std::sin(2.0944 * k), 1.0 * i});
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = 3 * i + k, b = 3 * i + (k + 1) % 3;
      mesh.triangles.push_back({{a, b, b + 3}});
      mesh.triangles.push_back({{a, b + 3, a + 3}});
    }
  mesh.triangles.push_back({{2, 1, 0}});
  mesh.triangles.push_back({{3 * n - 3, 3 * n - 2, 3 * n - 1}});
  return mesh;
}

// Some of the vertices at one place.
inline RawMesh coincident_sphere(std::uint64_t triangles, double share) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(0, 1);
  const Vec3d place{0.3, 0.2, 0.1};
  return changed_sphere(triangles, [&](Vec3d p) { return any(random) < share ? place : p; });
}

// Positions that have nothing to do with the connectivity.
inline RawMesh shuffled_sphere(std::uint64_t triangles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(0, 1);
  return changed_sphere(triangles, [&](Vec3d) { return Vec3d{any(random), any(random), any(random)}; });
}

// Vertices at distances of 1 to 10^-12 from the centre.
inline RawMesh spiky_sphere(std::uint64_t triangles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-12, 0);
  return changed_sphere(triangles, [&](Vec3d p) { return std::pow(10, any(random)) * p; });
}

}  // namespace lodestone::test
