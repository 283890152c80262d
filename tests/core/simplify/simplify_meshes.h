// Small meshes for the simplifier tests: the shapes on which simplifiers go wrong.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/simplify/contract/simplifier.h"
#include "tests/test_meshes.h"

namespace lodestone::simplify_test {

struct TestMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> locked;  // empty: nothing is locked

  // The result points into this mesh.
  [[nodiscard]] SimplifyInput input(float max_displacement, std::size_t target) {
    locked.resize(positions.size(), 0);
    return {positions, triangles, locked, max_displacement, target};
  }
};

// Smooth bumps, the same on every machine that has IEEE sines to within rounding.
inline float bump(Vec3f p) { return 0.05f * std::sin(9 * p.x + 1) * std::sin(7 * p.y + 2) * std::sin(8 * p.z + 3); }

// The octahedral sphere, displaced along the radius: 8 * 4^levels triangles.
inline TestMesh bumpy_sphere(int levels, float amplitude = 1) {
  TestMesh m;
  test::octahedral_sphere(m.positions, m.triangles, levels);
  for (Vec3f& p : m.positions) p = (1 + amplitude * bump(p)) * p;
  return m;
}

// As add_grid, but `place` takes floats.
template <class Place>
TestMesh grid(std::uint32_t columns, std::uint32_t rows, bool wraps, Place place) {
  TestMesh m;
  const auto in_float = [&](double u, double v) { return place(static_cast<float>(u), static_cast<float>(v)); };
  test::add_grid(columns, rows, wraps, in_float, m.positions, m.triangles);
  return m;
}

inline TestMesh plane(std::uint32_t n) {
  return grid(n, n, false, [](float u, float v) { return Vec3f{u, v, 0}; });
}

inline TestMesh terrain(std::uint32_t n) {
  return grid(n, n, false, [](float u, float v) { return Vec3f{u, v, bump({2 * u, 2 * v, 0.3f})}; });
}

inline TestMesh torus(std::uint32_t around, std::uint32_t across) {
  return grid(around, across, true, [](float u, float v) {
    constexpr float turn = 2 * std::numbers::pi_v<float>;
    const float r = 1 + 0.4f * std::cos(turn * v);
    return Vec3f{r * std::cos(turn * u), r * std::sin(turn * u), 0.4f * std::sin(turn * v)};
  });
}

// A strip a thousand times longer than wide: needles that are nearly lines.
inline TestMesh slivers(std::uint32_t n) {
  return grid(n, 2, false, [](float u, float v) { return Vec3f{u, 1e-3f * v, 1e-4f * std::sin(40 * u)}; });
}

// Closed box, n^2 quads a side, welded: flat sides, sharp edges.
inline TestMesh box(std::uint32_t n) {
  TestMesh m;
  test::add_cube(
      n, [](Vec3d p) { return to_float(p); }, m.positions, m.triangles);
  return m;
}

inline TestMesh both(TestMesh a, const TestMesh& b, Vec3f offset) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  for (const Vec3f& p : b.positions) a.positions.push_back(p + offset);
  for (const auto& [v] : b.triangles) a.triangles.push_back({{v[0] + first, v[1] + first, v[2] + first}});
  return a;
}

// Fans of `pages` sheets around one shared axis: every edge of the axis is non-manifold.
inline TestMesh book(std::uint32_t pages, std::uint32_t n) {
  TestMesh m;
  for (std::uint32_t j = 0; j <= n; ++j) m.positions.push_back({0, 0, static_cast<float>(j) / static_cast<float>(n)});
  for (std::uint32_t p = 0; p < pages; ++p) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(p) / static_cast<float>(pages);
    std::vector<std::uint32_t> last(n + 1);
    for (std::uint32_t j = 0; j <= n; ++j) last[j] = j;
    for (std::uint32_t i = 1; i <= n; ++i) {
      std::vector<std::uint32_t> next(n + 1);
      for (std::uint32_t j = 0; j <= n; ++j) {
        next[j] = static_cast<std::uint32_t>(m.positions.size());
        const float r = static_cast<float>(i) / static_cast<float>(n);
        m.positions.push_back({r * std::cos(angle), r * std::sin(angle), m.positions[j].z});
      }
      for (std::uint32_t j = 0; j < n; ++j) {
        m.triangles.push_back({{last[j], next[j], next[j + 1]}});
        m.triangles.push_back({{last[j], next[j + 1], last[j + 1]}});
      }
      last = next;
    }
  }
  return m;
}

// Locks what lies outside |coordinate - 0| < 0.9 of the largest: the border of a block.
inline void lock_outside(TestMesh& m, float limit) {
  m.locked.assign(m.positions.size(), 0);
  for (std::size_t v = 0; v < m.positions.size(); ++v) {
    const Vec3f p = m.positions[v];
    m.locked[v] = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > limit;
  }
}

}  // namespace lodestone::simplify_test
