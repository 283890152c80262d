// Camera paths that follow from a model.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "core/base/error.h"
#include "core/mesh/up_axis.h"
#include "render/camera/camera.h"
#include "tests/naive_hierarchy.h"
#include "tests/render/moved_torus.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using test::moved_torus;
using test::torus;

const Hierarchy& terrain() {
  static const auto small = test::naive_hierarchy(test::terrain_mesh(32), 2);
  return small.hierarchy;
}

// From a point to the nearest vertex of the finest level.
double to_surface(const Hierarchy& h, Vec3d p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Cell& cell : h.cells_of(h.finest()))
    for (const Vec3f v : cell.positions) nearest = std::min(nearest, length(h.transform.to_model(v) - p));
  return nearest;
}

TEST(ModelPath, OrbitSeesTheWholeSphereWhateverTheAspect) {
  const Hierarchy h = moved_torus();
  const Sphere sphere = bounding_sphere(h);
  for (const double aspect : {0.5, 1.0, 2.0}) {
    const std::vector<Camera> path = orbit_path(sphere, 12, {{0, 0, 1}, aspect});
    ASSERT_EQ(path.size(), 12u);
    const double distance = length(path[0].position - sphere.centre);
    const double tangent = std::tan(std::asin(sphere.radius / distance));  // of the cone around the sphere
    const double tan_y = std::tan(path[0].vertical_fov / 2), smaller = std::min(tan_y, tan_y * aspect);
    EXPECT_NEAR(tangent, smaller, 1e-9) << aspect;
    for (std::size_t i = 0; i < path.size(); ++i) {
      EXPECT_NEAR(length(path[i].position - sphere.centre), distance, 1e-6 * distance);
      EXPECT_EQ(path[i].target, sphere.centre);
      const double step = length(path[(i + 1) % 12].position - path[i].position);
      EXPECT_NEAR(step, length(path[1].position - path[0].position), 1e-6 * step);
    }
  }
  EXPECT_NEAR(distance_to_see(1, std::numbers::pi / 4, 1.5), 2.613, 5e-4);
  EXPECT_THROW((void)orbit_path(h, 0), InputError);
  EXPECT_THROW((void)orbit_path(Hierarchy{}, 3), InputError);
}

TEST(ModelPath, StandsUprightByTheModel) {
  Hierarchy h = moved_torus();
  const Sphere sphere = bounding_sphere(h);
  const std::vector<Camera> flat = orbit_path(h, 8), down = fly_in_path(h, 8);
  for (const UpAxis axis : {UpAxis::y, UpAxis::x, UpAxis::minus_z, UpAxis::minus_y, UpAxis::minus_x}) {
    h.transform.up = {axis, false};
    const Vec3d up = direction_of(axis, {});
    const std::vector<Camera> turned = orbit_path(h, 8), flown = fly_in_path(h, 8);
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_EQ(turned[i].up, up);
      EXPECT_EQ(flown[i].up, up);
      // As far above the middle, seen along the up axis, as with z up.
      EXPECT_NEAR(dot(turned[i].position - sphere.centre, up), flat[i].position.z - sphere.centre.z,
                  1e-9 * sphere.radius);
    }
    EXPECT_GT(dot(flown[0].position - sphere.centre, up), 0);
  }
}

TEST(ModelPath, FlyInDescendsEvenlyAndNeverMeetsTheSurface) {
  for (const Hierarchy& h : {moved_torus(), Hierarchy(terrain())}) {
    const Box3f& box = h.cells[0].bounds;
    const double radius = 0.5 * h.transform.scale * length(box.hi - box.lo);
    const std::vector<Camera> path = fly_in_path(h, 60);
    ASSERT_EQ(path.size(), 60u);
    const auto distance_at = [&](std::size_t i) { return length(path[i].position - path[i].target); };
    EXPECT_NEAR(distance_at(0), 6 * radius, 1e-6 * radius);
    EXPECT_NEAR(distance_at(59), 0.02 * radius, 1e-6 * radius);
    for (std::size_t i = 1; i < path.size(); ++i)
      EXPECT_NEAR(distance_at(i) / distance_at(i - 1), distance_at(1) / distance_at(0), 1e-6);

    // The target is on the surface, the camera never is.
    const double edge = h.transform.scale * h.levels.back().max_edge * cell_size(h.finest());
    EXPECT_LT(to_surface(h, path.back().target), edge);
    for (const Camera& camera : path)
      EXPECT_GT(to_surface(h, camera.position), 0.1 * length(camera.position - camera.target));
  }
}

TEST(ModelPath, WalkGoesAroundCloseToTheSurface) {
  for (const Hierarchy& h : {moved_torus(), Hierarchy(terrain())}) {
    const Sphere sphere = bounding_sphere(h);
    const std::vector<Camera> path = walk_path(h, 49, up_of(h));
    ASSERT_EQ(path.size(), 49u);
    EXPECT_LE(length(path.front().position - path.back().position), 1e-9 * sphere.radius);
    double azimuths = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double height = to_surface(h, path[i].position);
      EXPECT_GT(height, 0.02 * sphere.radius) << i;
      EXPECT_LT(height, 0.2 * sphere.radius) << i;
      if (i == 0) continue;
      const Vec3d from = path[i - 1].position - sphere.centre, to = path[i].position - sphere.centre;
      azimuths += std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
      EXPECT_LT(length(to - from), 0.25 * sphere.radius) << i;
      EXPECT_GT(dot(path[i - 1].target - path[i - 1].position, to - from), 0) << i << ": looks ahead";
    }
    EXPECT_NEAR(azimuths, 2 * std::numbers::pi, 1e-6);
  }
}

TEST(ModelPath, WanderSeesTheModelFromAllAroundAndNeverFromWithin) {
  const Hierarchy h = moved_torus();
  const Sphere sphere = bounding_sphere(h);
  const std::vector<Camera> path = wander_path(sphere, 200, {0, 0, 1});
  ASSERT_EQ(path.size(), 200u);
  std::set<int> octants;
  double lowest = 1, highest = -1;
  double nearest = 8, farthest = 0;
  for (const Camera& camera : path) {
    const Vec3d away = (1 / sphere.radius) * (camera.position - sphere.centre);
    const double distance = length(away);
    nearest = std::min(nearest, distance), farthest = std::max(farthest, distance);
    octants.insert(static_cast<int>(std::floor(std::atan2(away.y, away.x) / (std::numbers::pi / 4))));
    lowest = std::min(lowest, away.z / distance), highest = std::max(highest, away.z / distance);
    EXPECT_LE(length(camera.target - sphere.centre), 0.3001 * sphere.radius);
  }
  EXPECT_GE(nearest, 1.0999);
  EXPECT_LT(nearest, 1.2);
  EXPECT_LE(farthest, 8.001);
  EXPECT_GT(farthest, 7);
  EXPECT_EQ(octants.size(), 8u);
  EXPECT_LT(lowest, -0.2);
  EXPECT_GT(highest, 0.8);
}

TEST(ModelPath, NamesAreThoseOfThePaths) {
  const Hierarchy h = moved_torus();
  const Framing framing{up_of(h), 1.5};
  EXPECT_EQ(model_path("orbit", h, 5, framing), orbit_path(h, 5, 1.5));
  EXPECT_EQ(model_path("fly-in", h, 5, framing), fly_in_path(h, 5, 1.5));
  EXPECT_EQ(model_path("walk", h, 5, framing), walk_path(h, 5, framing.up));
  EXPECT_EQ(model_path("wander", h, 5, framing), wander_path(bounding_sphere(h), 5, framing.up));
  EXPECT_EQ(model_path_names().size(), 4u);
  EXPECT_FALSE(is_model_path("walk.json"));
}

TEST(ModelPath, IsOfOneFrameToo) {
  for (const std::string& name : model_path_names()) {
    EXPECT_EQ(model_path(name, torus(), 1, {}).size(), 1u) << name;
    EXPECT_THROW((void)model_path(name, torus(), 0, {}), InputError) << name;
    EXPECT_THROW((void)model_path(name, {}, 5, {}), InputError) << name;
  }
}

}  // namespace
}  // namespace lodestone
