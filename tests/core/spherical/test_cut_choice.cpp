// The choice of the rotation under which a sphere is cut open.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/spherical/octahedron/cut_choice.h"
#include "core/spherical/octahedron/unfold.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/spherical/map_to_sphere.h"
#include "tests/core/spherical/painted_sphere.h"
#include "tests/test_data.h"

namespace lodestone::spherical {
namespace {

constexpr Affine3d in_place{};

// The length of the cut on the surface, from the edges between the copies.
double cut_length(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                  const std::vector<Vec3d>& directions) {
  const Unfolding cut = unfold(triangles, directions);
  std::vector<Vec3d> all = positions;
  for (const AddedVertex& a : cut.added)
    all.push_back(a.weight[0] * positions[a.corner[0]] +
                  (a.weight[1] * positions[a.corner[1]] + a.weight[2] * positions[a.corner[2]]));
  double sum = 0;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const SquarePoint a = cut.place[cut.corners[t].v[k]], b = cut.place[cut.corners[t].v[(k + 1) % 3]];
      if ((a.s == b.s && (a.s == 0 || a.s == 1)) || (a.t == b.t && (a.t == 0 || a.t == 1)))
        sum += 0.5 * length(all[cut.triangles[t].v[k]] - all[cut.triangles[t].v[(k + 1) % 3]]);
    }
  return sum;
}

TEST(CutChoice, ASphereIsCutAlongFourQuarterCircles) {
  const test::SphereMesh sphere = test::octahedron_on_sphere(5);
  const CutMeasure measure(sphere.directions, sphere.triangles, sphere.directions);
  const CutChoice choice = measure.choose();
  for (const CutCost& cost : {choice.before, choice.cost}) {
    EXPECT_NEAR(cost.length, 2 * 3.14159, 0.03);
    EXPECT_GT(cost.exposure, 0.98);
  }
  EXPECT_LE(choice.cost.cost, choice.before.cost);
}

// An ellipsoid four times as long as wide.
TEST(CutChoice, LengthIsThatOfTheCutMesh) {
  test::SphereMesh sphere = test::octahedron_on_sphere(5);
  rotate(sphere, test::Numbers(2).rotation());
  std::vector<Vec3d> positions;
  for (const Vec3d d : sphere.directions) positions.push_back({d.x, d.y, 4 * d.z});
  const CutMeasure measure(positions, sphere.triangles, sphere.directions);
  test::Numbers number(7);
  for (int k = 0; k < 8; ++k) {
    const Affine3d rotation = k == 0 ? in_place : number.rotation();
    const double length = cut_length(positions, sphere.triangles, rotated(sphere.directions, rotation));
    EXPECT_NEAR(measure.measure(rotation).length, length, 0.03 * length);
  }
}

TEST(CutChoice, LongPartsAreNotCutAlong) {
  test::SphereMesh sphere = test::octahedron_on_sphere(5);
  std::vector<Vec3d> positions;  // with a spike
  for (const Vec3d d : sphere.directions) {
    const double near = std::max(0.0, dot(d, {0, 0, -1}) - 0.8);
    positions.push_back((1 + 100 * near * near) * d);
  }
  const CutMeasure measure(positions, sphere.triangles, sphere.directions);
  const CutChoice choice = measure.choose();
  EXPECT_GT(choice.before.length, 15);
  EXPECT_LT(choice.cost.length, 7);
  EXPECT_NEAR(choice.rotation.determinant(), 1, 1e-12);
  test::Numbers number(3);
  for (int k = 0; k < 300; ++k) EXPECT_LT(choice.cost.cost, measure.measure(number.rotation()).cost * 1.0001);
  EXPECT_EQ(measure.choose().rotation, choice.rotation);
}

// Few triangles have few samples, and few trials; the cut is a good one nevertheless.
TEST(CutChoice, SmallMeshesAreCutWhereItIsShort) {
  for (const int level : {0, 1, 2, 3}) {
    const test::SphereMesh sphere = test::octahedron_on_sphere(level);
    std::vector<Vec3d> positions;
    for (const Vec3d d : sphere.directions) positions.push_back({d.x, d.y, 4 * d.z});
    const CutMeasure measure(positions, sphere.triangles, sphere.directions);
    const CutChoice choice = measure.choose();
    EXPECT_LE(choice.cost.cost, choice.before.cost);
    const double length = cut_length(positions, sphere.triangles, rotated(sphere.directions, choice.rotation));
    EXPECT_NEAR(choice.cost.length, length, 0.2 * length) << level;
    EXPECT_LT(length, 1.02 * cut_length(positions, sphere.triangles, sphere.directions)) << level;
  }
}

// A dent as wide as a third of the sphere, so deep that its ground sees little of the sky.
TEST(CutChoice, HiddenPartsAreNotExposed) {
  const test::SphereMesh sphere = test::octahedron_on_sphere(5);
  std::vector<Vec3d> positions;
  for (const Vec3d d : sphere.directions) {
    const double near = std::max(0.0, dot(d, {0, 0, -1}) - 0.75) / 0.25;
    positions.push_back({d.x, d.y, d.z + 2.2 * std::min(1.0, 2 * near) * 0.75});
  }
  const CutMeasure measure(positions, sphere.triangles, sphere.directions);
  EXPECT_LT(measure.measure(in_place).exposure, 0.85);  // its pole is in the dent
  const Affine3d over{{Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, -1}}, {}};
  EXPECT_GT(measure.measure(over).exposure, measure.measure(in_place).exposure + 0.1);
}

TEST(CutChoice, AnUncoveredSphereIsRefused) {
  test::SphereMesh sphere = test::octahedron_on_sphere(3);
  sphere.triangles.resize(sphere.triangles.size() / 2);
  EXPECT_THROW(CutMeasure(sphere.directions, sphere.triangles, sphere.directions), InputError);
}

TEST(CutChoice, RealModelsAreCutShorterThanByChance) {
  LODESTONE_MODEL_OR_SKIP(path, "textured/Gutenberg/Gutenberg.obj");
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  const IndexedMesh mesh = prepare_mesh(load_mesh(path, *scheduler), repairs, *scheduler);
  const Surface surface = test::surface_of(mesh);
  SphereMapReport report;
  const std::vector<Vec3d> directions = map_to_sphere(surface.positions, surface.triangles, {}, *scheduler, report);
  const CutMeasure measure(surface.positions, surface.triangles, directions);
  const CutChoice choice = measure.choose();
  const double length = cut_length(surface.positions, surface.triangles, rotated(directions, choice.rotation));
  double mean = 0;
  test::Numbers number(5);
  for (int k = 0; k < 10; ++k)
    mean += cut_length(surface.positions, surface.triangles, rotated(directions, number.rotation())) / 10;
  RecordProperty("chosen", std::to_string(length));
  RecordProperty("mean", std::to_string(mean));
  EXPECT_LT(length, 0.9 * mean);
}

}  // namespace
}  // namespace lodestone::spherical
