// Small meshes for tests: plain, normalised, welded.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone::test {

// Scales into the unit cube, longest extent 1.
inline IndexedMesh normalised(std::vector<Vec3d> positions, std::vector<Triangle> triangles) {
  Vec3d lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};
  for (const Vec3d p : positions) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  IndexedMesh mesh;
  mesh.transform = {lo, std::max(hi.x - lo.x, std::max(hi.y - lo.y, hi.z - lo.z))};
  for (const Vec3d p : positions) mesh.positions.push_back(mesh.transform.to_normalised(p));
  mesh.triangles = std::move(triangles);
  return mesh;
}

// Splits each triangle on the unit sphere into four, `times` times, with the new vertices on the sphere.
template <class Vec>
void subdivide_on_sphere(std::vector<Vec>& positions, std::vector<Triangle>& triangles, int times) {
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(positions.size()));
      if (is_new) {
        const Vec sum = positions[a] + positions[b];
        positions.push_back((1 / length(sum)) * sum);
      }
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [v] : triangles) {
      const std::uint32_t ab = middle(v[0], v[1]), bc = middle(v[1], v[2]), ca = middle(v[2], v[0]);
      finer.insert(finer.end(), {{{v[0], ab, ca}}, {{v[1], bc, ab}}, {{v[2], ca, bc}}, {{ab, bc, ca}}});
    }
    triangles = std::move(finer);
  }
}

// Closed: an octahedron, subdivided n times, on the sphere, displaced by a wave of the given amplitude.
inline IndexedMesh sphere_mesh(int subdivisions, double amplitude = 0.05) {
  std::vector<Vec3d> p{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> t{{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}}, {{3, 0, 4}},
                          {{2, 0, 5}}, {{1, 2, 5}}, {{3, 1, 5}}, {{0, 3, 5}}};
  subdivide_on_sphere(p, t, subdivisions);
  for (Vec3d& d : p) d = (1 + amplitude * std::sin(9 * d.x) * std::sin(7 * d.y + 1) * std::cos(8 * d.z)) * d;
  return normalised(std::move(p), std::move(t));
}

// Open: n x n squares, two triangles each, over a height field.
inline IndexedMesh terrain_mesh(std::uint32_t n, double height = 0.1) {
  std::vector<Vec3d> p;
  std::vector<Triangle> t;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = double(i) / n, y = double(j) / n;
      p.push_back({x, y, height * std::sin(11 * x + 3 * y) * std::cos(13 * y)});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      t.push_back({{a, b, d}});
      t.push_back({{a, d, c}});
    }
  return normalised(std::move(p), std::move(t));
}

inline RawMesh raw_of(const IndexedMesh& mesh) {
  RawMesh raw;
  for (const Vec3f p : mesh.positions) raw.positions.push_back(to_double(p));
  raw.triangles = mesh.triangles;
  return raw;
}

// Closed, genus 1: n x m squares around a torus.
inline IndexedMesh torus_mesh(std::uint32_t n, std::uint32_t m) {
  std::vector<Vec3d> p;
  std::vector<Triangle> t;
  constexpr double turn = 6.283185307179586;
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double u = turn * i / n, v = turn * j / m, r = 1 + 0.4 * std::cos(v);
      p.push_back({r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v)});
    }
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = (i + 1) % n, l = (j + 1) % m;
      const std::uint32_t a = j * n + i, b = j * n + k, c = l * n + i, d = l * n + k;
      t.push_back({{a, b, d}});
      t.push_back({{a, d, c}});
    }
  return normalised(std::move(p), std::move(t));
}

}  // namespace lodestone::test
