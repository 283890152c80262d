// Visible points and their distance from a mesh.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/metrics/geometry/surface_coverage.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

TEST(SurfaceCoverage, CountsWhatIsNear) {
  const IndexedMesh mesh = sphere_mesh(4, 0);
  const RawMesh raw = raw_of(mesh);
  const auto serial = make_serial_scheduler();
  const std::vector<Vec3d> points{{0.5, 0.5, 1.0}, {0.5, 0.5, 1.1}, {0.5, 0.5, 1.2}, {1.3, 0.5, 0.5}};
  const SurfaceCoverage c = measure_coverage(points, raw, Transform{}, 0.15, *serial);
  EXPECT_EQ(c.share, 0.5);
  EXPECT_NEAR(c.max, 0.3, 2e-3);
  EXPECT_NEAR(c.rms, std::sqrt((0.01 + 0.04 + 0.09) / 4), 2e-3);
  EXPECT_EQ(measure_coverage({}, raw, Transform{}, 0.1, *serial).share, 1);
  const SurfaceCoverage nothing = measure_coverage(points, RawMesh{}, Transform{}, 0.1, *serial);
  EXPECT_EQ(nothing.share, 0);
  EXPECT_TRUE(std::isinf(nothing.rms));
}

// From all around, a convex body shows each face in proportion to its area (Cauchy), and nothing that lies inside.
TEST(SurfaceCoverage, PicturesShowFacesByAreaAndNothingInside) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  add_box({0, 0, 0}, {0.9, 0.6, 0.3}, 1, positions, triangles);
  add_box({0.2, 0.2, 0.1}, {0.4, 0.4, 0.2}, 1, positions, triangles);
  IndexedMesh mesh;
  for (const Vec3d& p : positions) mesh.positions.push_back(to_float(p));
  mesh.triangles = triangles;
  const auto serial = make_serial_scheduler();
  const std::vector<Vec3d> points = points_in_pictures(mesh, {}, *serial);
  EXPECT_EQ(points, points_in_pictures(mesh, {}, *make_tbb_scheduler(3)));
  EXPECT_GT(points.size(), 10'000u);
  const double extent[] = {0.9, 0.6, 0.3}, area[] = {0.18, 0.27, 0.54};
  std::size_t faces[3]{};
  for (const Vec3d& p : points) {
    const double at[] = {p.x, p.y, p.z};
    int on = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const bool here = std::min(std::abs(at[k]), std::abs(at[k] - extent[k])) < 1e-6;
      faces[k] += here, on += here;
    }
    EXPECT_GE(on, 1);
  }
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(static_cast<double>(faces[k]) / static_cast<double>(points.size()), area[k] / 0.99, 0.01);
  EXPECT_TRUE(points_in_pictures({}, {}, *serial).empty());
}

}  // namespace
}  // namespace lodestone::test
