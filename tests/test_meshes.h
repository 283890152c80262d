// Small meshes for tests: plain, normalised, welded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

// Makes an octahedron on the unit sphere, subdivided `times` times.
template <class Vec>
void octahedral_sphere(std::vector<Vec>& positions, std::vector<Triangle>& triangles, int times) {
  positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  triangles = {{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}}, {{3, 0, 4}}, {{2, 0, 5}}, {{1, 2, 5}}, {{3, 1, 5}}, {{0, 3, 5}}};
  subdivide_on_sphere(positions, triangles, times);
}

// Adds squares of two triangles over [0, 1]^2. If the grid wraps, opposite sides are joined. `place` gives the position
// at (u, v).
template <class Vec, class Place>
void add_grid(std::uint32_t columns, std::uint32_t rows, bool wraps, const Place& place, std::vector<Vec>& positions,
              std::vector<Triangle>& triangles) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  const std::uint32_t across = wraps ? columns : columns + 1, down = wraps ? rows : rows + 1;
  for (std::uint32_t j = 0; j < down; ++j)
    for (std::uint32_t i = 0; i < across; ++i) positions.push_back(place(double(i) / columns, double(j) / rows));
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return first + j % down * across + i % across; };
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      triangles.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1)}});
      triangles.push_back({{at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
    }
}

// Adds the surface of the cube [0, 1]^3 of n x n squares a side, two triangles each, whose sides share their vertices.
// `place` gives the position of a point of the cube.
template <class Vec, class Place>
void add_cube(std::uint32_t n, const Place& place, std::vector<Vec>& positions, std::vector<Triangle>& triangles) {
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> ids;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t side : {0u, n})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto corner = [&](std::uint32_t a, std::uint32_t b) {
            std::array<std::uint32_t, 3> c{};
            c[axis] = side, c[(axis + 1) % 3] = a, c[(axis + 2) % 3] = b;
            const auto [at, is_new] = ids.try_emplace(c, static_cast<std::uint32_t>(positions.size()));
            if (is_new) positions.push_back(place(Vec3d{double(c[0]) / n, double(c[1]) / n, double(c[2]) / n}));
            return at->second;
          };
          std::uint32_t a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
          if (side == 0) std::swap(b, d);  // counter-clockwise seen from outside
          triangles.insert(triangles.end(), {{{a, b, c}}, {{a, c, d}}});
        }
}

// Closed: the octahedral sphere, displaced by a wave of the given amplitude.
inline IndexedMesh sphere_mesh(int subdivisions, double amplitude = 0.05) {
  std::vector<Vec3d> p;
  std::vector<Triangle> t;
  octahedral_sphere(p, t, subdivisions);
  for (Vec3d& d : p) d = (1 + amplitude * std::sin(9 * d.x) * std::sin(7 * d.y + 1) * std::cos(8 * d.z)) * d;
  return normalised(std::move(p), std::move(t));
}

// Open: n x n squares, two triangles each, over a height field.
inline IndexedMesh terrain_mesh(std::uint32_t n, double height = 0.1) {
  std::vector<Vec3d> p;
  std::vector<Triangle> t;
  const auto place = [&](double x, double y) {
    return Vec3d{x, y, height * std::sin(11 * x + 3 * y) * std::cos(13 * y)};
  };
  add_grid(n, n, false, place, p, t);
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
  const auto place = [](double u, double v) {
    constexpr double turn = 6.283185307179586;
    const double r = 1 + 0.4 * std::cos(turn * v);
    return Vec3d{r * std::cos(turn * u), r * std::sin(turn * u), 0.4 * std::sin(turn * v)};
  };
  add_grid(n, m, true, place, p, t);
  return normalised(std::move(p), std::move(t));
}

}  // namespace lodestone::test
