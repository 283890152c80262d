// The distance on the screen: against a brute force, and within the tolerance that the radii were made for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/spatial/point_triangle.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/drawn/screen_error.h"
#include "parallel/hierarchy/build.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/small_meshes.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

constexpr ImageSize size{320, 200};

Hierarchy build(IndexedMesh mesh, int finest, Scheduler& scheduler) {
  BuildConfig config;
  config.sigma0 = 0.5f;
  config.finest_level = finest;
  return build_hierarchy(std::move(mesh), config, scheduler);
}

Radii radii_for(const Hierarchy& hierarchy, const Camera& camera, float pixels) {
  RadiiConfig config;
  config.pixel_error = pixels;
  config.image_height = size.height;
  config.vertical_fov = static_cast<float>(camera.vertical_fov);
  config.aspect = static_cast<float>(size.width) / size.height;
  return make_radii(hierarchy, config);
}

testing::Frame frame_of(const Hierarchy& hierarchy, const Radii& radii, const Camera& camera) {
  return testing::make_frame(hierarchy, radii, Blend::smoothstep, viewpoint(camera, hierarchy.transform));
}

// Every point against every triangle, projected by hand.
double brute_force(const Hierarchy& h, const testing::Frame& f, const ViewProjection& vp) {
  struct Corners {
    Vec3d a, b, c;
  };
  std::vector<Corners> drawn, full;
  std::vector<Vec3d> drawn_points, full_points;
  const auto add = [](std::span<const Vec3f> p, const Cell& cell, std::vector<Corners>& to) {
    for (const Triangle& t : cell.triangles)
      to.push_back({to_double(p[t.v[0]]), to_double(p[t.v[1]]), to_double(p[t.v[2]])});
  };
  for (const SelectedCell& s : f.selection.cells) {
    std::vector<Vec3f> morphed(h.cells[s.cell].positions.size());
    morph_cell(f.context, s.cell, morphed);
    add(morphed, h.cells[s.cell], drawn);
    for (const Vec3f p : morphed) drawn_points.push_back(to_double(p));
  }
  for (const Corners& t : drawn) drawn_points.push_back((1.0 / 3) * (t.a + t.b + t.c));
  for (const Cell& cell : h.cells_of(h.finest())) {
    add(cell.positions, cell, full);
    for (const Vec3f p : cell.positions) full_points.push_back(to_double(p));
  }
  const auto place = [&](Vec3d p) {
    const auto row = [&](std::size_t r) {
      return vp.m[4 * r] * p.x + vp.m[4 * r + 1] * p.y + vp.m[4 * r + 2] * p.z + double{vp.m[4 * r + 3]};
    };
    return std::array{row(0) / row(3), row(1) / row(3), row(2) / row(3)};
  };
  double largest = 0;
  const auto measure = [&](const std::vector<Vec3d>& points, const std::vector<Corners>& others) {
    for (const Vec3d p : points) {
      const auto from = place(p);
      if (std::any_of(from.begin(), from.end(), [](double v) { return std::abs(v) > 1; })) continue;
      double nearest = std::numeric_limits<double>::infinity();
      Vec3d at;
      for (const Corners& t : others) {
        const Vec3d q = nearest_on_triangle(p, t.a, t.b, t.c).point;
        if (const double d = dot(p - q, p - q); d < nearest) nearest = d, at = q;
      }
      const auto to = place(at);
      largest = std::max(largest, std::hypot((to[0] - from[0]) * size.width / 2, (to[1] - from[1]) * size.height / 2));
    }
  };
  measure(drawn_points, full);
  measure(full_points, drawn);
  return largest;
}

ScreenError error_of(const testing::Frame& frame, const ViewProjection& projection, const MeasuredSurface& finest,
                     Scheduler& scheduler) {
  return screen_error(MeasuredSurface(drawn_mesh(frame.context, frame.selection)), finest, Screen(projection, size),
                      scheduler);
}

TEST(ScreenError, IsTheBruteForce) {
  const auto scheduler = make_tbb_scheduler(2);
  const Hierarchy h = build(test::torus_mesh(48, 24), 3, *scheduler);
  const MeasuredSurface finest(finest_mesh(h));
  double largest = 0;
  for (const Camera& camera : orbit_path(h, 3)) {
    const Radii radii = radii_for(h, camera, 20);
    const testing::Frame f = frame_of(h, radii, camera);
    const ViewProjection vp = view_projection(camera, h, size);
    const ScreenError error = error_of(f, vp, finest, *scheduler);
    EXPECT_GT(error.points, 100u);
    EXPECT_NEAR(error.largest(), brute_force(h, f, vp), 1e-6);
    largest = std::max(largest, error.largest());
  }
  EXPECT_GT(largest, 0.5);
}

TEST(ScreenError, IsNoneWhereAllOfTheSurfaceIsDrawn) {
  const auto scheduler = make_serial_scheduler();
  const Hierarchy h = build(test::terrain_mesh(20), 2, *scheduler);
  const Camera camera = orbit_path(h, 1).front();
  RadiiConfig config;
  config.kappa0 = 1000;
  const Radii radii = make_radii(h, config);
  const testing::Frame f = frame_of(h, radii, camera);
  const ScreenError error = error_of(f, view_projection(camera, h, size), MeasuredSurface(finest_mesh(h)), *scheduler);
  EXPECT_GT(error.points, 100u);
  EXPECT_EQ(error.largest(), 0);
}

TEST(ScreenError, StaysWithinTheToleranceOfTheRadii) {
  const auto scheduler = make_tbb_scheduler(2);
  double share = 0;
  for (const IndexedMesh& mesh : {test::sphere_mesh(5), test::terrain_mesh(96), test::torus_mesh(128, 64)}) {
    const Hierarchy h = build(IndexedMesh(mesh), 4, *scheduler);
    const MeasuredSurface finest(finest_mesh(h));
    for (const auto& path : {orbit_path(h, 4), fly_in_path(h, 8)})
      for (const Camera& camera : path)
        for (const float pixels : {0.5f, 2.0f, 8.0f}) {
          const Radii radii = radii_for(h, camera, pixels);
          const testing::Frame f = frame_of(h, radii, camera);
          const double error = error_of(f, view_projection(camera, h, size), finest, *scheduler).largest();
          EXPECT_LE(error, pixels);
          share = std::max(share, error / pixels);
        }
  }
  EXPECT_GT(share, 0.2);  // the tolerance is used
}

}  // namespace
}  // namespace lodestone
