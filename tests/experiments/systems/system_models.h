// Models for the tests of systems that make levels of their own, and flights over them.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "experiments/metrics/drawn/drawn_mesh.h"
#include "experiments/systems/surface/welded_surface.h"
#include "experiments/systems/system_flight.h"
#include "render/backends/make_renderer.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::testing {

inline const Hierarchy& torus() {
  static const test::NaiveHierarchy made = test::naive_hierarchy(test::torus_mesh(100, 50), 3);
  return made.hierarchy;
}

// An open height field of so many posts, not a power of two of them, with hills of several sizes.
inline IndexedMesh hills(std::uint32_t columns, std::uint32_t rows) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  const auto place = [](double u, double v) {
    const double height =
        0.05 * std::sin(9 * u + 2 * v) + 0.02 * std::cos(31 * v - 7 * u) + 0.004 * std::sin(170 * u * v);
    return Vec3d{u, 0.7 * v, height};
  };
  test::add_grid(columns - 1, rows - 1, false, place, positions, triangles);
  return test::normalised(std::move(positions), std::move(triangles));
}

inline const Hierarchy& terrain() {
  static const test::NaiveHierarchy made = test::naive_hierarchy(hills(150, 101), 3);
  return made.hierarchy;
}

inline DrawnMesh to_drawn(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  DrawnMesh mesh;
  for (const Vec3f p : positions) mesh.positions.push_back(to_double(p));
  mesh.triangles.assign(triangles.begin(), triangles.end());
  return mesh;
}

// Viewpoints around and in the unit cube, and reaches from all detail to none.
template <class Visit>
void for_views(int count, const Visit& visit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-1, 2), power(0, 5);
  for (int i = 0; i < count; ++i)
    visit(Vec3f{place(random), place(random), place(random)}, std::pow(10.0, double{power(random)}));
}

inline std::vector<Camera> approach(int frames) {
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / frames;
    path.push_back({{0.5 + 0.3 * t, -3 + 2.4 * t, 1.4 - 0.6 * t}, {0.5, 0.5, 0.15}});
  }
  return path;
}

// A flight of systems over a model, at a tolerance in pixels.
inline std::vector<SystemRow> fly(const Hierarchy& model, const std::vector<std::string>& systems, float pixel_error,
                                  int frames = 5) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of("model"), {{&model}});
  SystemFlightConfig config;
  config.cameras = approach(frames);
  config.view = view_config(view.scene(), {320, 240});
  config.view.radii.kappa0.reset();
  config.view.radii.pixel_error = pixel_error;
  config.systems = systems;
  config.quality = {.with_flip = false, .with_ssim = false};
  config.screen = true;
  return fly_systems(view, *renderer, config, *scheduler);
}

}  // namespace lodestone::testing
