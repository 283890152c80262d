// Normal deviation and the figures of a mesh against its reference.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "core/spatial/point_triangle.h"
#include "core/spatial/surface_samples.h"
#include "experiments/metrics/drawn/position_resolution.h"
#include "experiments/metrics/geometry/geometry_error.h"
#include "experiments/studies/study_input.h"
#include "parallel/mesh/compare.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

// A square of n x n parts in the plane through the x axis that is turned about it by an angle in degrees.
RawMesh square(std::uint32_t n, double degrees, double z = 0) {
  RawMesh mesh;
  const double a = degrees * std::numbers::pi / 180;
  const auto place = [&](double u, double v) { return Vec3d{u, v * std::cos(a), z + v * std::sin(a)}; };
  test::add_grid(n, n, false, place, mesh.positions, mesh.triangles);
  return mesh;
}

void turn_over(RawMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t.v[0], t.v[1]);
}

Vec3d normal_of(const RawMesh& mesh, const Triangle& t) {
  const Vec3d a = mesh.positions[t.v[0]];
  return cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a);
}

// Every sample against every triangle; the first of equally near ones.
DirectedDeviation naive_deviation(const ComparedMesh& from, const ComparedMesh& to, const CompareConfig& config) {
  const SurfaceSamples samples = samples_of(from, config);
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles;
  samples.take(samples.vertices(), samples.size(), points, &triangles);
  std::vector<double> angles;
  const auto normal = [](const ComparedMesh& mesh, const Triangle& t) {
    const Vec3d a = mesh.positions[t.v[0]];
    return cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    double smallest = std::numeric_limits<double>::infinity();
    const Triangle* nearest = nullptr;
    for (const Triangle& t : to.triangles) {
      const double d = nearest_on_triangle(points[i], to.positions[t.v[0]], to.positions[t.v[1]], to.positions[t.v[2]])
                           .squared_distance;
      if (d < smallest) smallest = d, nearest = &t;
    }
    const Vec3d a = normal(from, from.triangles[triangles[i]]), b = normal(to, *nearest);
    angles.push_back(std::acos(std::clamp(dot(a, b) / (length(a) * length(b)), -1.0, 1.0)) * 180 / std::numbers::pi);
  }
  DirectedDeviation result;
  result.samples = angles.size();
  for (const double a : angles) result.mean += a / static_cast<double>(angles.size());
  std::sort(angles.begin(), angles.end());
  result.max = angles.back();
  result.p99 = angles[static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(angles.size()))) - 1];
  return result;
}

TEST(NormalDeviation, IsTheAngleBetweenPlanes) {
  const auto scheduler = make_serial_scheduler();
  for (const double degrees : {0.0, 0.001, 5.0, 60.0}) {
    const NormalDeviation found = normal_deviation(square(3, 0), square(5, degrees), {1000}, *scheduler);
    for (const DirectedDeviation& d : {found.forward, found.backward}) {
      EXPECT_NEAR(d.mean, degrees, 1e-9);
      EXPECT_NEAR(d.p99, degrees, 1e-9);
      EXPECT_NEAR(d.max, degrees, 1e-9);
      EXPECT_EQ(d.samples, 1000u);
    }
  }
  RawMesh other = square(4, 0);
  turn_over(other);
  EXPECT_NEAR(normal_deviation(square(3, 0), other, {100}, *scheduler).forward.mean, 180, 1e-9);
}

TEST(NormalDeviation, AMeshDoesNotDeviateFromItself) {
  const auto scheduler = make_serial_scheduler();
  const RawMesh mesh = generate_mesh({Shape::torus, 3000, 1});
  const NormalDeviation same = normal_deviation(mesh, mesh, {}, *scheduler);
  // But where a sample falls on an edge.
  EXPECT_LT(same.forward.mean, 1e-3);
  EXPECT_EQ(same.forward.p99, 0);
}

TEST(NormalDeviation, EqualsItsSlowTwin) {
  const auto scheduler = make_serial_scheduler();
  const RawMesh a = generate_mesh({Shape::sphere, 600, 1}), b = generate_mesh({Shape::sphere, 300, 1});
  const CompareConfig config{2000};
  const NormalDeviation fast = normal_deviation(a, b, config, *scheduler);
  const ComparedPair pair = prepare_comparison(a, b);
  const auto expect_near = [](const DirectedDeviation& x, const DirectedDeviation& y) {
    EXPECT_EQ(x.samples, y.samples);
    // Where two triangles are equally near (their edge is), the two may take different ones.
    EXPECT_NEAR(x.mean, y.mean, 0.01 * y.mean);
    EXPECT_NEAR(x.p99, y.p99, 0.02 * y.p99);
    EXPECT_NEAR(x.max, y.max, 0.1 * y.max);
    EXPECT_GT(y.mean, 1);
  };
  expect_near(fast.forward, naive_deviation(pair.mesh[0], pair.mesh[1], config));
  expect_near(fast.backward, naive_deviation(pair.mesh[1], pair.mesh[0], config));
}

TEST(NormalDeviation, TrianglesWithoutANormalAreLeftOut) {
  const auto scheduler = make_serial_scheduler();
  RawMesh line = square(2, 0);
  for (Triangle& t : line.triangles) t.v[2] = t.v[1];
  const NormalDeviation found = normal_deviation(square(2, 0), line, {50}, *scheduler);
  EXPECT_EQ(found.forward.samples, 0u);
  EXPECT_EQ(found.backward.samples, 0u);
  EXPECT_EQ(found.forward.mean, 0);
}

TEST(NormalDeviation, IsTheSameForAnyNumberOfWorkers) {
  const RawMesh a = generate_mesh({Shape::sphere, 3000, 1}), b = generate_mesh({Shape::sphere, 700, 1});
  const NormalDeviation serial = normal_deviation(a, b, {}, *make_serial_scheduler());
  for (const int threads : {2, 5}) {
    const NormalDeviation other = normal_deviation(a, b, {}, *make_tbb_scheduler(threads));
    EXPECT_EQ(other.forward.mean, serial.forward.mean);
    EXPECT_EQ(other.backward.p99, serial.backward.p99);
    EXPECT_EQ(other.forward.max, serial.forward.max);
  }
}

TEST(SurfaceSamples, SayWhichTriangleTheyLieOn) {
  const RawMesh mesh = generate_mesh({Shape::sphere, 500, 1});
  const SurfaceSamples samples(mesh.positions, mesh.triangles, 3000);
  std::vector<Vec3d> points, alone;
  std::vector<std::uint32_t> triangles{9, 9};
  samples.take(samples.vertices() + 100, samples.size(), points, &triangles);
  samples.take(samples.vertices() + 100, samples.size(), alone);
  EXPECT_EQ(points, alone);
  ASSERT_EQ(points.size(), triangles.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Triangle& t = mesh.triangles[triangles[i]];
    EXPECT_LT(nearest_on_triangle(points[i], mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]])
                  .squared_distance,
              1e-24);
    EXPECT_GT(length(normal_of(mesh, t)), 0);
  }
}

TEST(GeometryError, PutsTheMeasuresTogether) {
  const auto scheduler = make_serial_scheduler();
  const RawMesh reference = square(4, 0), mesh = square(2, 0, 0.25);
  const GeometryError error = geometry_error(reference, mesh, {500}, *scheduler);
  const double share = 0.25 / std::sqrt(2.0);
  EXPECT_NEAR(error.hausdorff, share, 1e-12);
  EXPECT_NEAR(error.rms, share, 1e-12);
  EXPECT_NEAR(error.mean, share, 1e-12);
  EXPECT_NEAR(error.p99, share, 1e-12);
  EXPECT_NEAR(error.distance.diagonal, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(error.normals.forward.mean, 0, 1e-9);
  EXPECT_EQ(error.quality.triangles, 8u);
  EXPECT_EQ(error.quality.slivers, 0u);
  // The larger of both directions.
  const GeometryError part = geometry_error(square(4, 0), square(4, 30), {500}, *scheduler);
  EXPECT_DOUBLE_EQ(part.hausdorff * part.distance.diagonal,
                   std::max(part.distance.forward.max, part.distance.backward.max));
  EXPECT_THROW((void)geometry_error(reference, {}, {}, *scheduler), InputError);
}

MeshQuality right_triangle(double leg) {
  const std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {0, leg, 0}};
  return measure_quality(positions, std::vector<Triangle>{{{0, 1, 2}}});
}

// With legs 1 and t the longest edge is sqrt(1 + t^2), and the height above it t over that.
TEST(MeshQuality, SliversAreTwentyTimesAsLongAsHigh) {
  for (const double t : {1.0, 0.5, 1.0 / 19, 1.0 / 21, 1e-6}) {
    const MeshQuality quality = right_triangle(t);
    EXPECT_NEAR(quality.worst_aspect, (1 + t * t) / t, 1e-9 / t) << t;
    EXPECT_EQ(quality.slivers, t < 0.05 ? 1u : 0u) << t;
    EXPECT_EQ(quality.no_area, 0u);
    EXPECT_NEAR(quality.border_length, 1 + t + std::sqrt(1 + t * t), 1e-12);
  }
  EXPECT_EQ(sliver_aspect, 20);
}

TEST(MeshQuality, TrianglesWithoutAreaAreSliversWithoutAspect) {
  const std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{{0, 1, 2}}, {{0, 1, 3}}, {{0, 1, 1}}};  // the last one does not count
  const MeshQuality quality = measure_quality(positions, triangles);
  EXPECT_EQ(quality.triangles, 2u);
  EXPECT_EQ(quality.no_area, 1u);
  EXPECT_EQ(quality.slivers, 1u);
  EXPECT_EQ(quality.sliver_share(), 0.5);
  EXPECT_DOUBLE_EQ(quality.worst_aspect, 2);
  EXPECT_EQ(right_triangle(0).worst_aspect, 0);
  EXPECT_EQ(measure_quality({}, {}).sliver_share(), 0);
}

TEST(MeshQuality, BordersAreEdgesOfOneTriangle) {
  const RawMesh sheet = square(4, 30);
  EXPECT_NEAR(measure_quality(sheet.positions, sheet.triangles).border_length, 4, 1e-12);
  EXPECT_EQ(measure_quality(sheet.positions, sheet.triangles).border_edges, 16u);
  const RawMesh closed = generate_mesh({Shape::box, 300, 1});
  EXPECT_EQ(measure_quality(closed.positions, closed.triangles).border_length, 0);
}

// A distance within rounding is not an error; twice as much is.
TEST(GeometryColumns, AreZeroBelowTheResolutionOfPositions) {
  const auto scheduler = make_serial_scheduler();
  RawMesh reference = generate_mesh({Shape::torus, 2000, 1}), copy = reference;
  const Vec3d far{100.1, -70.3, 0.7};
  for (Vec3d& p : copy.positions) p = (p + far) - far;
  Row row;
  add_geometry(row, reference, copy, *scheduler);
  EXPECT_GT(geometry_error(reference, copy, {}, *scheduler).hausdorff, 0);
  for (const char* column : {"rms", "error_max", "error_mean", "error_p99"}) EXPECT_EQ(row.at(column), 0) << column;

  const double apart = 2 * position_resolution * std::sqrt(2.0);
  add_geometry(row, square(4, 0), square(4, 0, apart), *scheduler);
  EXPECT_NEAR(row.at("rms").get<double>(), 200 * position_resolution, 1e-12);
  EXPECT_EQ(row.at("normal_mean"), 0);
}

}  // namespace
}  // namespace lodestone
