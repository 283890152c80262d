// Small meshes for the simplifier tests: the shapes on which simplifiers go wrong.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
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

// Octahedron subdivided `levels` times, on the unit sphere, displaced along the radius: 8 * 4^levels triangles.
inline TestMesh bumpy_sphere(int levels, float amplitude = 1) {
  TestMesh m{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
             {{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}}, {{3, 0, 4}}, {{2, 0, 5}}, {{1, 2, 5}}, {{3, 1, 5}}, {{0, 3, 5}}},
             {}};
  test::subdivide_on_sphere(m.positions, m.triangles, levels);
  for (Vec3f& p : m.positions) p = (1 + amplitude * bump(p)) * p;
  return m;
}

// Grid of 2 columns rows triangles over [0,1]^2; wrapping joins opposite sides. `place` gives the position at (u, v).
template <class Place>
TestMesh grid(std::uint32_t columns, std::uint32_t rows, bool wrap, Place place) {
  TestMesh m;
  const std::uint32_t across = wrap ? columns : columns + 1, down = wrap ? rows : rows + 1;
  for (std::uint32_t j = 0; j < down; ++j)
    for (std::uint32_t i = 0; i < across; ++i)
      m.positions.push_back(
          place(static_cast<float>(i) / static_cast<float>(columns), static_cast<float>(j) / static_cast<float>(rows)));
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return (j % down) * across + i % across; };
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      m.triangles.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1)}});
      m.triangles.push_back({{at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
    }
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
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> ids;
  const auto vertex = [&](std::array<std::uint32_t, 3> g) {
    const auto [at, is_new] = ids.try_emplace(g, static_cast<std::uint32_t>(m.positions.size()));
    const auto f = [&](int k) { return static_cast<float>(g[k]) / static_cast<float>(n); };
    if (is_new) m.positions.push_back({f(0), f(1), f(2)});
    return at->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const std::uint32_t side : {0u, n})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto corner = [&](std::uint32_t a, std::uint32_t b) {
            std::array<std::uint32_t, 3> g{};
            g[axis] = side, g[(axis + 1) % 3] = a, g[(axis + 2) % 3] = b;
            return vertex(g);
          };
          std::array<std::uint32_t, 4> q{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
          if (side == 0) std::swap(q[1], q[3]);
          m.triangles.push_back({{q[0], q[1], q[2]}});
          m.triangles.push_back({{q[0], q[2], q[3]}});
        }
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
