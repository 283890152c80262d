// Small surfaces for the tests of the metrics: closed, open, with long triangles, torn and pinched. A few thousand
// triangles, inside the unit cube, every vertex used.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/test_meshes.h"

namespace lodestone::testing {

struct NamedMesh {
  std::string name;
  IndexedMesh mesh;
};

// Model space is the unit cube.
inline IndexedMesh normalised(std::vector<Vec3d> points, std::vector<Triangle> triangles) {
  IndexedMesh mesh = test::normalised(std::move(points), std::move(triangles));
  mesh.transform = {};
  return mesh;
}

// The surface of a cube as n x n squares per face, its points (in [-1, 1]^3) moved by `place`.
template <typename Place>
IndexedMesh cube_surface(std::uint32_t n, const Place& place) {
  std::vector<Vec3d> points;
  std::vector<Triangle> triangles;
  test::add_cube(
      n,
      [&](Vec3d p) {
        return place(2.0 * p - Vec3d{1, 1, 1});
      },
      points, triangles);
  return normalised(std::move(points), std::move(triangles));
}

// nu x nv squares of a parameter domain, whose opposite sides are joined if it wraps.
template <typename Place>
IndexedMesh sheet(std::uint32_t nu, std::uint32_t nv, bool wraps, const Place& place) {
  std::vector<Vec3d> points;
  std::vector<Triangle> triangles;
  test::add_grid(nu, nv, wraps, place, points, triangles);
  return normalised(std::move(points), std::move(triangles));
}

inline double ripple(Vec3d p) {
  return std::sin(7 * p.x + 1) * std::cos(5 * p.y) + 0.5 * std::sin(13 * p.z + 3 * p.x) * std::sin(11 * p.y + 2);
}

inline IndexedMesh sphere_mesh(std::uint32_t n) {
  return cube_surface(n, [](Vec3d p) {
    const Vec3d unit = (1 / length(p)) * p;
    return (1 + 0.06 * ripple(unit)) * unit;
  });
}

// A sphere on which a few vertices stand far out: the triangles around them are longer than several cells.
inline IndexedMesh spiky_mesh(std::uint32_t n) {
  int vertex = 0;
  return cube_surface(n, [&](Vec3d p) {
    const bool spike = ++vertex % 197 == 50;
    return ((spike ? 1.6 + 0.3 * ripple(p) : 1.0) / length(p)) * p;
  });
}

inline IndexedMesh box_mesh(std::uint32_t n) {
  return cube_surface(n, [](Vec3d p) { return p; });
}

inline IndexedMesh torus_mesh(std::uint32_t n) {
  return sheet(2 * n, n, true, [](double u, double v) {
    const double a = 6.283185307179586 * u, b = 6.283185307179586 * v, r = 0.4 + 0.05 * std::sin(5 * a + 3 * b);
    return Vec3d{(1 + r * std::cos(b)) * std::cos(a), (1 + r * std::cos(b)) * std::sin(a), r * std::sin(b)};
  });
}

inline IndexedMesh terrain_mesh(std::uint32_t n) {
  return sheet(n, n, false, [](double u, double v) { return Vec3d{u, v, 0.12 * ripple({u, v, u * v})}; });
}

// A terrain some of whose triangles are gone: many borders, and vertices at which only points of triangles meet.
inline IndexedMesh torn_mesh(std::uint32_t n) {
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
inline IndexedMesh non_manifold_mesh(std::uint32_t n) {
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
