// Images of positions, and the meshes over them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/spatial/mesh_distance.h"
#include "core/spherical/resample/geometry_image.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

// An ellipsoid that is mapped by the sphere it was made from.
struct Ellipsoid {
  Surface surface;
  std::vector<Vec3d> directions;

  explicit Ellipsoid(int subdivisions) {
    test::SphereMesh sphere = test::octahedron_on_sphere(subdivisions);
    rotate(sphere, test::Numbers(8).rotation());
    directions = sphere.directions;
    for (const Vec3d d : directions) surface.positions.push_back({0.5 + 0.5 * d.x, 0.5 + 0.3 * d.y, 0.5 + 0.2 * d.z});
    surface.triangles = sphere.triangles;
    surface.source_vertex.assign(directions.size(), 0);
    surface.source_triangle.assign(sphere.triangles.size(), 0);
  }
  [[nodiscard]] RawMesh mesh() const {
    RawMesh raw;
    raw.positions = surface.positions;
    raw.triangles = surface.triangles;
    return raw;
  }
};

TEST(GeometryImage, SamplesAreOnTheSurface) {
  const Ellipsoid ellipsoid(5);
  const GeometryImage image = sample_geometry(ellipsoid.surface, ellipsoid.directions, 33);
  const SampleGrid grid{33, SampleGrid::Placing::on_sides};
  for (std::uint32_t y = 0; y < 33; ++y)
    for (std::uint32_t x = 0; x < 33; ++x) {
      const Vec3d d = direction_of(grid.place(x, y)), p = image.positions[y * 33 + x];
      EXPECT_LT(length(p - Vec3d{0.5 + 0.5 * d.x, 0.5 + 0.3 * d.y, 0.5 + 0.2 * d.z}), 1e-3);
    }
  for (std::uint32_t i = 0; i < 33; ++i) {
    EXPECT_EQ(image.positions[i], image.positions[32 - i]);
    EXPECT_EQ(image.positions[33 * i + 32], image.positions[33 * (32 - i) + 32]);
  }
  EXPECT_EQ(image.positions.front(), image.positions.back());
}

TEST(GeometryImage, MeshIsClosedAndOutward) {
  const Ellipsoid ellipsoid(4);
  for (const std::uint32_t n : {3u, 5u, 9u, 11u, 65u}) {
    const RawMesh mesh = remesh(sample_geometry(ellipsoid.surface, ellipsoid.directions, n));
    EXPECT_EQ(mesh.positions.size(), std::size_t{n - 1} * (n - 1) + 2);
    EXPECT_EQ(mesh.triangles.size(), 2 * std::size_t{n - 1} * (n - 1));
    EXPECT_EQ(kind_of(mesh.triangles, mesh.positions.size()), (SurfaceKind{.components = 1, .euler = 2})) << n;
    double volume = 0;
    for (const Triangle& t : mesh.triangles)
      volume += dot(mesh.positions[t.v[0]], cross(mesh.positions[t.v[1]], mesh.positions[t.v[2]])) / 6;
    EXPECT_GT(volume, n == 3 ? 0.02 : 0.05);
    EXPECT_LT(volume, 0.126);  // of the ellipsoid: 0.1257
  }
}

TEST(GeometryImage, FinerImagesAreNearer) {
  const Ellipsoid ellipsoid(5);
  double last = 1;
  for (const std::uint32_t n : {9u, 17u, 33u, 65u}) {
    const GeometryImage image = sample_geometry(ellipsoid.surface, ellipsoid.directions, n);
    const MeshDistance distance = compare_meshes(ellipsoid.mesh(), remesh(image), {.area_points = 20'000});
    const double rms = std::max(distance.forward.rms, distance.backward.rms) / distance.diagonal;
    EXPECT_LT(rms, 0.5 * last) << n;
    last = rms;
  }
  EXPECT_LT(last, 5e-4);
}

// Every second sample of an image is the next coarser image.
TEST(GeometryImage, LevelsAreNested) {
  const Ellipsoid ellipsoid(3);
  const GeometryImage fine = sample_geometry(ellipsoid.surface, ellipsoid.directions, 33),
                      coarse = sample_geometry(ellipsoid.surface, ellipsoid.directions, 17);
  for (std::size_t y = 0; y < 17; ++y)
    for (std::size_t x = 0; x < 17; ++x) EXPECT_EQ(coarse.positions[17 * y + x], fine.positions[33 * 2 * y + 2 * x]);
}

TEST(GeometryImage, SixteenBitsAreWithinHalfAStep) {
  const Ellipsoid ellipsoid(4);
  const GeometryImage image = sample_geometry(ellipsoid.surface, ellipsoid.directions, 17);
  const WideGeometry wide = wide_geometry(image);
  EXPECT_NEAR(wide.step, 1.0 / 65535, 1e-7);
  const GeometryImage back = geometry_of(wide);
  ASSERT_EQ(back.n, 17u);
  for (std::size_t i = 0; i < image.positions.size(); ++i) {
    const Vec3d off = back.positions[i] - image.positions[i];
    EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), 0.5001 * wide.step);
  }
  // Mirrored samples remain the same point.
  for (std::size_t i = 0; i < 17; ++i) EXPECT_EQ(back.positions[i], back.positions[16 - i]);
}

TEST(GeometryImage, WrongInputIsRefused) {
  Ellipsoid ellipsoid(2);
  for (const std::uint32_t n : {0u, 1u, 2u, 4u, 32'769u})
    EXPECT_THROW((void)sample_geometry(ellipsoid.surface, ellipsoid.directions, n), InputError);
  ellipsoid.surface.triangles.resize(100);
  EXPECT_THROW((void)sample_geometry(ellipsoid.surface, ellipsoid.directions, 9), InputError);
}

}  // namespace
}  // namespace lodestone::spherical
