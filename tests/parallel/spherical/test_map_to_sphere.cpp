// The map to the sphere: valid for every closed surface of genus 0, the same for any number of threads and any
// instructions, and as good as it is said to be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/base/error.h"
#include "core/base/instruction_set.h"
#include "core/math/orientation.h"
#include "parallel/mesh/load.h"
#include "parallel/spherical/map_to_sphere.h"
#include "tests/parallel/spherical/sphere_meshes.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

struct Mapped {
  std::vector<Vec3d> directions;
  SphereMapReport report;
};

Mapped map(const RawMesh& mesh, const SphereMapConfig& config = {}, int threads = 1) {
  const auto scheduler = threads == 1 ? make_serial_scheduler() : make_tbb_scheduler(threads);
  Mapped out;
  out.directions = map_to_sphere(mesh.positions, mesh.triangles, config, *scheduler, out.report);
  return out;
}

// Unit vectors; every triangle positively oriented, exactly; and the sphere covered once: the triangles' solid angles
// add up to that of the sphere, and the angles at each vertex to one turn.
void expect_valid(const RawMesh& mesh, const std::vector<Vec3d>& d) {
  ASSERT_EQ(d.size(), mesh.positions.size());
  for (const Vec3d p : d) ASSERT_NEAR(length(p), 1, 1e-14);
  std::vector<double> turn(d.size(), 0);
  double covered = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = d[t.v[0]], b = d[t.v[1]], c = d[t.v[2]];
    ASSERT_EQ(orientation(a, b, c), 1);
    covered += 2 * std::atan2(dot(a, cross(b - a, c - a)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = d[t.v[k]], q = d[t.v[(k + 1) % 3]] - p, r = d[t.v[(k + 2) % 3]] - p;
      turn[t.v[k]] += std::atan2(dot(p, cross(q, r)), dot(q, r) - dot(p, q) * dot(p, r));
    }
  }
  EXPECT_NEAR(covered, 4 * std::numbers::pi, 1e-6);
  for (const double angle : turn) ASSERT_NEAR(angle, 2 * std::numbers::pi, 1e-2);
}

void expect_mapped(const RawMesh& mesh, double least_efficiency, const SphereMapConfig& config = {}) {
  const Mapped mapped = map(mesh, config);
  ASSERT_NO_FATAL_FAILURE(expect_valid(mesh, mapped.directions));
  EXPECT_EQ(mapped.report.sums.flips, 0u);
  EXPECT_GE(mapped.report.sums.efficiency(), least_efficiency);
  EXPECT_EQ(mapped.report.attempts, 1u);
}

TEST(MapToSphere, PleasantSurfacesAreMappedWell) {
  ASSERT_NO_FATAL_FAILURE(expect_mapped(test::tetrahedron(), 0.3));
  ASSERT_NO_FATAL_FAILURE(expect_mapped(generate_mesh({Shape::box, 12, 1}), 0.66));
  ASSERT_NO_FATAL_FAILURE(expect_mapped(generate_mesh({Shape::box, 3000, 1}), 0.97));
  ASSERT_NO_FATAL_FAILURE(expect_mapped(test::bumpy_sphere(20'000), 0.99));
  ASSERT_NO_FATAL_FAILURE(expect_mapped(test::bipyramid(10), 0.67));
}

// The best map that keeps the symmetry has 0.040.
TEST(MapToSphere, AStretchedBallLosesItsSymmetry) {
  ASSERT_NO_FATAL_FAILURE(expect_mapped(test::stretched_ball(80'000, 100), 0.07, {.effort = SphereEffort::best}));
}

TEST(MapToSphere, MoreEffortGivesNoLess) {
  const RawMesh mesh = test::stretched_ball(5000, 6);
  double before = 0;
  for (const SphereEffort effort : {SphereEffort::fast, SphereEffort::normal, SphereEffort::best}) {
    const Mapped mapped = map(mesh, {.effort = effort});
    EXPECT_GE(mapped.report.sums.efficiency(), before - 1e-3);
    before = mapped.report.sums.efficiency();
  }
  EXPECT_GT(before, 0.5);
}

TEST(MapToSphere, ThreadsAndInstructionsDoNotMatter) {
  for (const RawMesh& mesh : {test::bumpy_sphere(30'000), test::stretched_ball(10'000, 50)}) {
    const std::vector<Vec3d> expected = map(mesh, {.instructions = InstructionSet::plain}).directions;
    for (const int threads : {1, 2, 3, 8})
      EXPECT_EQ(map(mesh, {}, threads).directions, expected) << threads << " threads";
  }
}

// Needles, faces without area, vertices on top of each other, and connectivity that leaves no room: a valid map.
TEST(MapToSphere, HardSurfacesAreMappedValidly) {
  const RawMesh hard[]{test::bipyramid(3000),
                       test::stacked_tetrahedra(3000, false),
                       test::stacked_tetrahedra(1000, true),
                       test::thin_tube(700),
                       test::coincident_sphere(5000, 0.3),
                       test::shuffled_sphere(5000),
                       test::spiky_sphere(5000),
                       test::stretched_ball(5000, 1e4),
                       test::stretched_ball(5000, 1e8),
                       test::stretched_ball(5000, 1e-6),
                       test::changed_sphere(5000,
                                            [](Vec3d p) {
                                              return Vec3d{p.x, p.y, 0};
                                            }),
                       test::changed_sphere(5000,
                                            [](Vec3d p) {
                                              return Vec3d{p.x, 0, 0};
                                            }),
                       test::changed_sphere(5000, [](Vec3d) {
                         return Vec3d{1, 2, 3};
                       })};
  for (const RawMesh& mesh : hard)
    for (const SphereEffort effort : {SphereEffort::fast, SphereEffort::normal}) {
      SCOPED_TRACE(&mesh - hard);
      const Mapped mapped = map(mesh, {.effort = effort});
      ASSERT_NO_FATAL_FAILURE(expect_valid(mesh, mapped.directions));
      EXPECT_EQ(mapped.report.sums.flips, 0u);
    }
}

TEST(MapToSphere, OffsetsAndScalesDoNotMatter) {
  const double expected = map(test::bumpy_sphere(5000)).report.sums.efficiency();
  const auto efficiency = [](double scale, double offset) {
    return map(test::changed_sphere(5000,
                                    [=](Vec3d p) {
                                      return scale * p + Vec3d{offset, offset, offset};
                                    }))
        .report.sums.efficiency();
  };
  EXPECT_NEAR(efficiency(1, 1e7), expected, 1e-3);
  EXPECT_NEAR(efficiency(1e-200, 0), expected, 1e-3);
  EXPECT_NEAR(efficiency(1e300, 0), expected, 1e-3);
}

TEST(MapToSphere, TheOrderOfVerticesDoesNotMatter) {
  RawMesh mesh = test::bumpy_sphere(5000);
  const double expected = map(mesh).report.sums.efficiency();
  std::vector<std::uint32_t> number(mesh.positions.size());
  for (std::uint32_t v = 0; v < number.size(); ++v) number[v] = v;
  std::shuffle(number.begin(), number.end(), std::mt19937(2));
  const std::vector<Vec3d> before = mesh.positions;
  for (std::uint32_t v = 0; v < number.size(); ++v) mesh.positions[number[v]] = before[v];
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v) v = number[v];
  EXPECT_NEAR(map(mesh).report.sums.efficiency(), expected, 1e-3);
}

std::string refusal(const RawMesh& mesh) {
  try {
    static_cast<void>(map(mesh));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(MapToSphere, RefusesWhatIsNoClosedSurfaceOfGenusZero) {
  RawMesh open = test::bumpy_sphere(500);
  open.triangles.pop_back();
  EXPECT_NE(refusal(open).find("3 edges lack a triangle"), std::string::npos) << refusal(open);
  RawMesh turned = test::bumpy_sphere(500);
  std::swap(turned.triangles[7].v[0], turned.triangles[7].v[1]);
  EXPECT_NE(refusal(turned).find("3 edges lack a triangle"), std::string::npos) << refusal(turned);
  const RawMesh torus = generate_mesh({Shape::torus, 500, 1});
  EXPECT_NE(refusal(torus).find("genus is 1"), std::string::npos) << refusal(torus);
  RawMesh two = test::tetrahedron();
  for (const Vec3d p : test::tetrahedron().positions) two.positions.push_back(p);
  for (Triangle t : test::tetrahedron().triangles) two.triangles.push_back({{t.v[0] + 4, t.v[1] + 4, t.v[2] + 4}});
  EXPECT_NE(refusal(two).find("2 components"), std::string::npos) << refusal(two);
  RawMesh touching = two;
  touching.positions.pop_back();
  for (Triangle& t : touching.triangles)
    for (std::uint32_t& v : t.v) v = v == 7 ? 0 : v;
  EXPECT_NE(refusal(touching).find("touch in a point"), std::string::npos) << refusal(touching);
  RawMesh unused = test::tetrahedron();
  unused.positions.push_back({});
  EXPECT_NE(refusal(unused).find("belong to no triangle"), std::string::npos) << refusal(unused);
  RawMesh degenerate = test::tetrahedron();
  degenerate.triangles.push_back({{0, 0, 1}});
  EXPECT_NE(refusal(degenerate).find("equal corners"), std::string::npos) << refusal(degenerate);
  RawMesh outside = test::tetrahedron();
  outside.triangles[0].v[0] = 9;
  EXPECT_NE(refusal(outside).find("has vertex 9 of 4"), std::string::npos) << refusal(outside);
  RawMesh infinite = test::tetrahedron();
  infinite.positions[1].y = std::numeric_limits<double>::infinity();
  EXPECT_NE(refusal(infinite).find("vertex 1 is not finite"), std::string::npos) << refusal(infinite);
  EXPECT_NE(refusal({}), "");
  RawMesh pillow;
  pillow.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, pillow.triangles = {{{0, 1, 2}}, {{0, 2, 1}}};
  EXPECT_NE(refusal(pillow).find("fewer than four"), std::string::npos) << refusal(pillow);
}

// A torus and a sphere have as many vertices and triangles as two spheres that are one.
TEST(MapToSphere, RefusesATorusBesideSpheres) {
  RawMesh mesh = generate_mesh({Shape::torus, 500, 1});
  const RawMesh sphere = test::tetrahedron();
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), sphere.positions.begin(), sphere.positions.end());
  for (const Triangle& t : sphere.triangles)
    mesh.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  ASSERT_EQ(mesh.triangles.size() + 4, 2 * mesh.positions.size());
  EXPECT_NE(refusal(mesh).find("2 components"), std::string::npos) << refusal(mesh);
}

TEST(MapToSphere, EffortsHaveNames) {
  EXPECT_EQ(sphere_effort("fast"), SphereEffort::fast);
  EXPECT_EQ(sphere_effort("best"), SphereEffort::best);
  EXPECT_THROW(static_cast<void>(sphere_effort("most")), InputError);
}

// Efficiencies that were reached; flips none.
TEST(MapToSphere, RealModelsAreMappedWell) {
  const std::pair<const char*, double> models[]{{"scans/armadillo.obj", 0.44}, {"scans/nefertiti.obj", 0.715}};
  for (const auto& [name, least] : models) {
    SCOPED_TRACE(name);
    LODESTONE_MODEL_OR_SKIP(path, name);
    const auto scheduler = make_serial_scheduler();
    const RawMesh mesh = load_mesh(path, *scheduler);
    ASSERT_NO_FATAL_FAILURE(expect_mapped(mesh, least));
  }
}

}  // namespace
}  // namespace lodestone
