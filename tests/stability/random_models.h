// Small surfaces, parameters and viewpoints as a few integers, so that a counterexample shrinks to small ones.
#pragma once

#include <rapidcheck.h>

#include <cmath>
#include <ios>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/raw_mesh.h"
#include "core/simplify/simplifiers.h"
#include "parallel/hierarchy/build.h"
#include "render/lod/radii.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

inline constexpr int shapes = 7;

// A surface, how it is built, and from where it is seen.
struct RandomModel {
  int shape = 0;            // sphere, box, torus, terrain, torn terrain, terrain with fins, soup
  int squares = 3;          // along a side
  int amplitude = 0;        // of the displacement, in sixteenths of the size
  unsigned seed = 0;        // of the displacement
  std::vector<int> soup{};  // of shape 6: coordinates on a grid of 5 x 5 x 5, nine for a triangle
  int sigma0 = 2;           // in tenths
  int levels = 2;
  bool half_levels = false;
  int simplifier = 0;
  bool endpoint = false;
  bool lattice = false;
  bool uniform = false, chebyshev = false;
  int blend = 0;
  int kappa = 1;       // in twentieths: kappa0 of radii by level, and by how much uniform ones are above the reach
  int beta = 5;        // in tenths
  int delta = 0;       // in tenths
  unsigned views = 0;  // seed of the viewpoints
};

// As the initializer of one, for the named cases of test_guarantees.cpp.
inline void showValue(const RandomModel& m, std::ostream& out) {
  out << "{.shape = " << m.shape << ", .squares = " << m.squares << ", .amplitude = " << m.amplitude
      << ", .seed = " << m.seed << ", .soup = {";
  for (std::size_t k = 0; k < m.soup.size(); ++k) out << (k > 0 ? ", " : "") << m.soup[k];
  out << std::boolalpha << "}, .sigma0 = " << m.sigma0 << ", .levels = " << m.levels
      << ", .half_levels = " << m.half_levels << ", .simplifier = " << m.simplifier << ", .endpoint = " << m.endpoint
      << ", .lattice = " << m.lattice << ", .uniform = " << m.uniform << ", .chebyshev = " << m.chebyshev
      << ", .blend = " << m.blend << ", .kappa = " << m.kappa << ", .beta = " << m.beta << ", .delta = " << m.delta
      << ", .views = " << m.views << "}";
}

// Wrapping grids need three squares a side.
inline rc::Gen<RandomModel> random_model() {
  using rc::gen::inRange;
  return rc::gen::build<RandomModel>(
      rc::gen::set(&RandomModel::shape, inRange(0, shapes)), rc::gen::set(&RandomModel::squares, inRange(3, 11)),
      rc::gen::set(&RandomModel::amplitude, inRange(0, 9)), rc::gen::set(&RandomModel::seed, inRange(0u, 1000u)),
      rc::gen::set(&RandomModel::soup, rc::gen::container<std::vector<int>>(inRange(0, 5))),
      rc::gen::set(&RandomModel::sigma0, inRange(1, 21)), rc::gen::set(&RandomModel::levels, inRange(1, 5)),
      rc::gen::set(&RandomModel::half_levels),
      rc::gen::set(&RandomModel::simplifier, inRange(0, static_cast<int>(simplifier_names().size()))),
      rc::gen::set(&RandomModel::endpoint), rc::gen::set(&RandomModel::lattice), rc::gen::set(&RandomModel::uniform),
      rc::gen::set(&RandomModel::chebyshev),
      rc::gen::set(&RandomModel::blend, inRange(0, static_cast<int>(all_blends().size()))),
      rc::gen::set(&RandomModel::kappa, inRange(1, 41)), rc::gen::set(&RandomModel::beta, inRange(1, 21)),
      rc::gen::set(&RandomModel::delta, inRange(0, 6)), rc::gen::set(&RandomModel::views, inRange(0u, 1000u)));
}

namespace detail {

inline RawMesh soup_of(const std::vector<int>& coordinates) {
  RawMesh mesh;
  for (std::size_t k = 0; k + 8 < coordinates.size(); k += 9) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::size_t c = k; c < k + 9; c += 3)
      mesh.positions.push_back({coordinates[c] / 4.0, coordinates[c + 1] / 4.0, coordinates[c + 2] / 4.0});
    mesh.triangles.push_back({{first, first + 1, first + 2}});
  }
  return mesh;
}

inline void tear(RawMesh& mesh, std::mt19937& random) {
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random() % 5 == 0; });
}

// A second sheet through some of the vertices, so that edges have three triangles, and some triangles from both sides.
inline void add_fins(RawMesh& mesh, std::mt19937& random) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const auto v = mesh.triangles[t].v;
    if (random() % 4 == 0) mesh.triangles.push_back({{v[0], v[2], v[1]}});
    if (random() % 4 != 0) continue;
    mesh.positions.push_back(mesh.positions[v[0]] + Vec3d{0, 0, 0.1});
    mesh.triangles.push_back({{v[0], v[1], static_cast<std::uint32_t>(mesh.positions.size() - 1)}});
  }
}

}  // namespace detail

inline RawMesh mesh_of(const RandomModel& m) {
  std::mt19937 random(m.seed);
  RawMesh mesh;
  const auto squares = static_cast<std::uint32_t>(m.squares);
  constexpr double turn = 6.283185307179586;
  switch (m.shape) {
    case 0:
      add_cube(
          squares,
          [](Vec3d p) {
            const Vec3d q = 2.0 * p - Vec3d{1, 1, 1};
            return (1 / length(q)) * q;
          },
          mesh.positions, mesh.triangles);
      break;
    case 1:
      add_cube(
          squares, [](Vec3d p) { return p; }, mesh.positions, mesh.triangles);
      break;
    case 2:
      add_grid(
          2 * squares, squares, true,
          [](double u, double v) {
            const double r = 1 + 0.4 * std::cos(turn * v);
            return Vec3d{r * std::cos(turn * u), r * std::sin(turn * u), 0.4 * std::sin(turn * v)};
          },
          mesh.positions, mesh.triangles);
      break;
    case 6:
      return detail::soup_of(m.soup);
    default:
      add_grid(
          2 * squares, 2 * squares, false,
          [](double u, double v) {
            return Vec3d{u, v, 0};
          },
          mesh.positions, mesh.triangles);
  }
  for (Vec3d& p : mesh.positions) {
    const auto part = [&] { return m.amplitude / 16.0 * (static_cast<double>(random() % 17) / 16 - 0.5); };
    const Vec3d by{part(), part(), part()};
    p = p + by;
  }
  if (m.shape == 4) detail::tear(mesh, random);
  if (m.shape == 5) detail::add_fins(mesh, random);
  return mesh;
}

inline BuildConfig build_config(const RandomModel& m) {
  BuildConfig config;
  config.sigma0 = static_cast<float>(m.sigma0) / 10;
  config.half_levels = m.half_levels;
  config.finest_level = m.half_levels ? 2 * m.levels - static_cast<int>(m.seed % 2) : m.levels;
  config.simplifier = simplifier_names()[static_cast<std::size_t>(m.simplifier)];
  if (m.endpoint) config.placement = Placement::endpoint;
  config.strategy = Strategy::serial;
  return config;
}

inline Lattice lattice_of(const RandomModel& m) { return {m.lattice ? 10 : 0}; }

inline DistanceMetric metric_of(const RandomModel& m) {
  return m.chebyshev ? DistanceMetric::chebyshev : DistanceMetric::euclidean;
}

// Admissible: a uniform kappa0 is above the reach and three guards. No uniform one is where levels share a grid.
inline Radii radii_of(const RandomModel& m, const Hierarchy& h) {
  RadiiConfig config;
  config.metric = metric_of(m);
  config.beta = static_cast<float>(m.beta) / 10;
  config.delta = static_cast<float>(m.delta) / 10;
  config.kappa0 = static_cast<float>(m.kappa) / 20;
  if (m.uniform && !m.half_levels) {
    config.rule = RadiiRule::uniform;
    config.kappa0 = (greatest_reach(h, config.metric) + 3 * config.delta) * (1 + *config.kappa0 / 10) + 1e-3f;
  }
  return make_radii(h, config);
}

// Adaptive radii for errors that have nothing to do with the cells: whatever is wanted, the constraint is met.
inline Radii adaptive_radii_of(const RandomModel& m, Hierarchy h) {
  RadiiConfig config;
  config.rule = RadiiRule::adaptive;
  config.metric = metric_of(m);
  config.beta = static_cast<float>(m.beta) / 10;
  config.delta = static_cast<float>(m.delta) / 10;
  std::mt19937 random(m.views);
  std::uniform_real_distribution<float> digits(-6, -1);
  for (Cell& cell : h.cells) cell.error = std::pow(10.0f, digits(random));
  return make_radii(h, config);
}

// The ends of a segment, near the model or far from it, on a vertex, on a corner of the grid or anywhere, and steps in
// between.
inline std::vector<Vec3f> viewpoints_of(const RandomModel& m, const Hierarchy& h, int steps) {
  std::mt19937 random(m.views);
  std::normal_distribution<float> normal;
  const auto leaves = h.cells_of(h.finest());
  const auto end = [&]() -> Vec3f {
    const Cell& leaf = leaves[random() % leaves.size()];
    const Vec3f near = leaf.positions[random() % leaf.positions.size()];
    const float n = 1 / cell_size(h.finest());
    const Vec3f way{normal(random), normal(random), normal(random)};
    const float distance = std::pow(2.0f, 3 - static_cast<float>(random() % 17));
    switch (random() % 4) {
      case 0:
        return near;
      case 1:
        return {std::round(near.x * n) / n, std::round(near.y * n) / n, std::round(near.z * n) / n};
      default:
        return near + distance * way;
    }
  };
  const Vec3f from = end(), to = end();
  std::vector<Vec3f> views;
  for (int k = 0; k <= steps; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(steps);
    views.push_back((1 - t) * from + t * to);
  }
  return views;
}

}  // namespace lodestone::test
