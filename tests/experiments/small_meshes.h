// Small surfaces for the tests of the metrics: closed, open, with long triangles, torn and pinched. A few thousand
// triangles, inside the unit cube, every vertex used.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone::testing {

struct NamedMesh {
  std::string name;
  IndexedMesh mesh;
};

// Moves and scales points into the unit cube, touching both ends of the longest axis.
inline IndexedMesh normalised(const std::vector<Vec3d>& points, std::vector<Triangle> triangles) {
  Vec3d lo = points.front(), hi = lo;
  for (const Vec3d& p : points) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const double scale = 1 / std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  IndexedMesh mesh;
  for (const Vec3d& p : points) mesh.positions.push_back(to_float(scale * (p - lo)));
  mesh.triangles = std::move(triangles);
  return mesh;
}

// The surface of a cube as n x n squares per face, its points (in [-1, 1]^3) moved by `place`.
template <typename Place>
IndexedMesh cube_surface(int n, const Place& place) {
  std::map<std::array<int, 3>, std::uint32_t> ids;
  std::vector<Vec3d> points;
  std::vector<Triangle> triangles;
  const auto id = [&](std::array<int, 3> c) {
    const auto [entry, is_new] = ids.try_emplace(c, static_cast<std::uint32_t>(points.size()));
    if (is_new) points.push_back(place(Vec3d{2.0 * c[0] / n - 1, 2.0 * c[1] / n - 1, 2.0 * c[2] / n - 1}));
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> c{};
            c[axis] = side;
            c[(axis + 1) % 3] = side ? i + di : j + dj;  // counter-clockwise seen from outside on both sides
            c[(axis + 2) % 3] = side ? j + dj : i + di;
            return id(c);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          triangles.push_back({{a, b, c}});
          triangles.push_back({{a, c, d}});
        }
  return normalised(points, std::move(triangles));
}

// nu x nv squares of a parameter domain [0, 1)^2 (wrapped) or [0, 1]^2.
template <typename Place>
IndexedMesh sheet(int nu, int nv, bool wrapped, const Place& place) {
  const int mu = wrapped ? nu : nu + 1, mv = wrapped ? nv : nv + 1;
  std::vector<Vec3d> points;
  for (int i = 0; i < mu; ++i)
    for (int j = 0; j < mv; ++j) points.push_back(place(double(i) / nu, double(j) / nv));
  const auto id = [&](int i, int j) { return static_cast<std::uint32_t>((i % mu) * mv + j % mv); };
  std::vector<Triangle> triangles;
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      triangles.push_back({{id(i, j), id(i + 1, j), id(i + 1, j + 1)}});
      triangles.push_back({{id(i, j), id(i + 1, j + 1), id(i, j + 1)}});
    }
  return normalised(points, std::move(triangles));
}

inline double ripple(Vec3d p) {
  return std::sin(7 * p.x + 1) * std::cos(5 * p.y) + 0.5 * std::sin(13 * p.z + 3 * p.x) * std::sin(11 * p.y + 2);
}

inline IndexedMesh sphere_mesh(int n) {
  return cube_surface(n, [](Vec3d p) {
    const Vec3d unit = (1 / length(p)) * p;
    return (1 + 0.06 * ripple(unit)) * unit;
  });
}

// A sphere on which a few vertices stand far out: the triangles around them are longer than several cells.
inline IndexedMesh spiky_mesh(int n) {
  int vertex = 0;
  return cube_surface(n, [&](Vec3d p) {
    const bool spike = ++vertex % 197 == 50;
    return ((spike ? 1.6 + 0.3 * ripple(p) : 1.0) / length(p)) * p;
  });
}

inline IndexedMesh box_mesh(int n) {
  return cube_surface(n, [](Vec3d p) { return p; });
}

inline IndexedMesh torus_mesh(int n) {
  return sheet(2 * n, n, true, [](double u, double v) {
    const double a = 6.283185307179586 * u, b = 6.283185307179586 * v, r = 0.4 + 0.05 * std::sin(5 * a + 3 * b);
    return Vec3d{(1 + r * std::cos(b)) * std::cos(a), (1 + r * std::cos(b)) * std::sin(a), r * std::sin(b)};
  });
}

inline IndexedMesh terrain_mesh(int n) {
  return sheet(n, n, false, [](double u, double v) { return Vec3d{u, v, 0.12 * ripple({u, v, u * v})}; });
}

// A terrain some of whose triangles are gone: many borders, and vertices at which only points of triangles meet.
inline IndexedMesh torn_mesh(int n) {
  IndexedMesh mesh = terrain_mesh(n);
  std::mt19937 random(5);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random() % 5 == 0; });
  std::vector<std::uint32_t> ids(mesh.positions.size(), ~0u);
  std::vector<Vec3f> used;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v) {
      if (ids[v] == ~0u) {
        ids[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.positions[v]);
      }
      v = ids[v];
    }
  mesh.positions = std::move(used);
  return mesh;
}

// Two families of ripples through the same vertices of one line, and every 7th triangle there a second time, reversed:
// edges of four and more triangles.
inline IndexedMesh non_manifold_mesh(int n) {
  IndexedMesh mesh = terrain_mesh(n);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; i += 7) {
    const Triangle& t = mesh.triangles[i];
    mesh.triangles.push_back({{t.v[0], t.v[2], t.v[1]}});
  }
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t v = 0; v + 1 < vertices; v += 3) {  // fins on edges of the sheet
    const Vec3f foot = mesh.positions[v];
    mesh.positions.push_back({foot.x, foot.y, std::min(foot.z + 0.04f, 1.0f)});
    mesh.triangles.push_back({{v, v + 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)}});
  }
  return mesh;
}

inline std::vector<NamedMesh> manifold_meshes() {
  std::vector<NamedMesh> meshes;
  meshes.push_back({"sphere", sphere_mesh(16)});
  meshes.push_back({"spiky", spiky_mesh(16)});
  meshes.push_back({"box", box_mesh(16)});
  meshes.push_back({"torus", torus_mesh(28)});
  meshes.push_back({"terrain", terrain_mesh(36)});
  return meshes;
}

inline std::vector<NamedMesh> all_meshes() {
  std::vector<NamedMesh> meshes = manifold_meshes();
  meshes.push_back({"torn", torn_mesh(36)});
  meshes.push_back({"non-manifold", non_manifold_mesh(30)});
  return meshes;
}

}  // namespace lodestone::testing
