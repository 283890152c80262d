// Positions of lights and eyes: the fit of the shadow map, and the eye of a projection.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/base/error.h"
#include "render/camera/light_view.h"
#include "render/camera/projection.h"
#include "tests/render/effect_scenes.h"

namespace lodestone {
namespace {

std::vector<Vec3d> some_points(std::uint32_t seed, int count, Vec3d centre, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-size, size);
  std::vector<Vec3d> points;
  for (int k = 0; k < count; ++k)
    points.push_back({centre.x + in(random), centre.y + in(random), centre.z + in(random)});
  return points;
}

Vec3d in_clip(const ViewProjection& vp, Vec3d p) {
  const auto row = [&](std::size_t r) {
    return vp.m[4 * r] * p.x + vp.m[4 * r + 1] * p.y + vp.m[4 * r + 2] * p.z + vp.m[4 * r + 3];
  };
  return {row(0), row(1), row(2)};
}

TEST(LightView, HoldsWhatItIsFittedTo) {
  for (const Vec3d direction :
       {Vec3d{0, 0, 1}, Vec3d{0, 0, -3}, Vec3d{1, 0, 0}, Vec3d{0.3, -0.5, 0.8}, Vec3d{1e-200, 2e-200, 0}})
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      const std::vector<Vec3d> receivers = some_points(seed, 10, {5, -3, 1}, 2),
                               casters = some_points(seed + 100, 10, {5, -3, 4}, 6);
      constexpr int texels = 512;
      const LightView view = fit_light(direction, receivers, casters, texels);
      EXPECT_NEAR(length(view.right), 1, 1e-12);
      EXPECT_NEAR(length(view.up), 1, 1e-12);
      EXPECT_NEAR(dot(view.right, view.up), 0, 1e-12);
      EXPECT_NEAR(dot(cross(view.right, view.up), view.towards_light), 1, 1e-12);
      const ViewProjection vp = light_projection(view, no_placement);
      const double inside = 1 - (2.0 * shadow_margin - 0.01) / texels;
      double lowest = 1e9;
      for (const Vec3d p : receivers) {
        const Vec3d c = in_clip(vp, p);
        EXPECT_LE(std::abs(c.x), inside);
        EXPECT_LE(std::abs(c.y), inside);
        EXPECT_LE(std::abs(c.z), 1);
        lowest = std::min(lowest, dot(p, view.towards_light));
      }
      for (const Vec3d p : casters) {
        EXPECT_GE(in_clip(vp, p).z, -1);  // nothing is cut off on the side of the light
        if (dot(p, view.towards_light) >= lowest) {
          EXPECT_LE(in_clip(vp, p).z, 1);
        }
      }
      // Points nearer to the light have less depth.
      EXPECT_LT(in_clip(vp, receivers[0] + 0.1 * view.towards_light).z, in_clip(vp, receivers[0]).z);
    }
}

// Receivers that come and go a little, as they do when a camera moves, move the map by whole texels.
TEST(LightView, MovesByWholeTexels) {
  constexpr int texels = 1024;
  const Vec3d direction{0.3, -0.5, 0.8};
  const std::vector<Vec3d> casters = some_points(1, 30, {0, 0, 0}, 4);
  const std::vector<Vec3d> first = some_points(2, 30, {0, 0, 0}, 2);
  const LightView before = fit_light(direction, first, casters, texels);
  int moved = 0;
  for (int step = 1; step < 50; ++step) {
    std::vector<Vec3d> receivers = first;
    for (Vec3d& p : receivers) p = p + (0.001 * step) * Vec3d{1, 0.7, 0};
    const LightView view = fit_light(direction, receivers, casters, texels);
    ASSERT_EQ(view.half, before.half);
    EXPECT_EQ(view.right, before.right);
    const double texel = 2 * view.half / texels;
    for (const double way : {view.centre_x - before.centre_x, view.centre_y - before.centre_y}) {
      EXPECT_NEAR(way / texel, std::round(way / texel), 1e-6);
      moved += std::abs(way) > texel / 2;
    }
    // The same depths, too.
    EXPECT_EQ(view.near, before.near);
    EXPECT_EQ(view.far, before.far);
  }
  EXPECT_GT(moved, 10);
}

TEST(LightView, PlacesModels) {
  const std::vector<Vec3d> receivers = some_points(3, 10, {100, 0, 0}, 1);
  const LightView view = fit_light({0, 0, 1}, receivers, {}, 256);
  const ModelPlacement twice{2, 0, 0, 99, 0, 2, 0, -1, 0, 0, 2, -1};
  const Vec3d model{0.25, 0.5, 0.75}, world{99.5, 0, 0.5};
  const Vec3d a = in_clip(light_projection(view, twice), model),
              b = in_clip(light_projection(view, no_placement), world);
  EXPECT_NEAR(a.x, b.x, 1e-4);
  EXPECT_NEAR(a.y, b.y, 1e-4);
  EXPECT_NEAR(a.z, b.z, 1e-4);
  const auto corners = corners_of({{0, 0, 0}, {1, 0.5f, 0.25f}}, twice);
  EXPECT_EQ(corners.front(), (Vec3d{99, -1, -1}));
  EXPECT_EQ(corners.back(), (Vec3d{101, 0, -0.5}));
}

TEST(LightView, TakesWhatHasNoExtent) {
  for (const std::vector<Vec3d>& receivers : {std::vector<Vec3d>{}, {{1, 2, 3}}, {{1e6, 1e6, 1e6}, {1e6, 1e6, 1e6}}}) {
    const LightView view = fit_light({0, 1, 1}, receivers, {}, 2048);
    EXPECT_GT(view.half, 0);
    EXPECT_GT(view.near, view.far);
    for (const float v : light_projection(view, no_placement).m) EXPECT_TRUE(std::isfinite(v));
  }
}

TEST(LightView, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3d> good{{0, 0, 0}, {1, 1, 1}}, bad{{0, nan, 0}};
  EXPECT_THROW((void)fit_light({0, 0, 0}, good, good, 256), InputError);
  EXPECT_THROW((void)fit_light({nan, 0, 1}, good, good, 256), InputError);
  EXPECT_THROW((void)fit_light({0, 0, 1}, bad, good, 256), InputError);
  EXPECT_THROW((void)fit_light({0, 0, 1}, good, bad, 256), InputError);
}

TEST(EyeOf, FindsCamerasAndDirections) {
  test::EffectScene scene;
  scene.eye = {0.9, -2.2, 1.3};
  scene.target = {0, 0, 0.1};
  const Eye eye = eye_of(test::detail::projection_of(scene, no_placement));
  EXPECT_EQ(eye.w, 1);
  EXPECT_NEAR(eye.at.x, scene.eye.x, 1e-4);
  EXPECT_NEAR(eye.at.y, scene.eye.y, 1e-4);
  EXPECT_NEAR(eye.at.z, scene.eye.z, 1e-4);
  // In the space of a model that is scaled, mirrored and moved.
  const Eye placed = eye_of(test::detail::projection_of(scene, {-2, 0, 0, 1, 0, 2, 0, 0, 0, 0, 2, 0}));
  EXPECT_NEAR(placed.at.x, -(scene.eye.x - 1) / 2, 1e-4);
  EXPECT_NEAR(placed.at.y, scene.eye.y / 2, 1e-4);

  const std::vector<Vec3d> points{{0, 0, 0}, {1, 1, 1}};
  const LightView light = fit_light({0.3, -0.5, 0.8}, points, points, 256);
  const Eye far = eye_of(light_projection(light, no_placement));
  EXPECT_EQ(far.w, 0);
  EXPECT_GT(dot(to_double(far.at), light.towards_light) / length(far.at), 0.9999);
  const Eye none = eye_of({});
  EXPECT_TRUE(is_finite(none.at));
}

}  // namespace
}  // namespace lodestone
