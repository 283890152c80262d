// The quadric kernel against its twins: the other instruction set byte for byte, the exact heap in accuracy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/base/error.h"
#include "core/hierarchy/construct/star_distance.h"
#include "core/simplify/quadric/quadric_reference.h"
#include "core/simplify/quadric/quadric_simplifier.h"
#include "core/spatial/point_triangle.h"
#include "tests/core/simplify/simplify_checks.h"
#include "tests/core/simplify/simplify_meshes.h"

namespace lodestone {
namespace {

using namespace simplify_test;

struct Case {
  const char* name;
  TestMesh mesh;
  float bound;
  std::size_t target;
};

std::vector<Case> cases() {
  TestMesh block = terrain(60);
  for (Vec3f& p : block.positions) p = 2.0f * p + Vec3f{-1, -1, 0};
  lock_outside(block, 0.9f);
  return {{"sphere", bumpy_sphere(5), 0.2f, 2000}, {"sphere, tight", bumpy_sphere(5), 0.05f, 0},
          {"torus", torus(80, 40), 0.5f, 1000},    {"plane", plane(40), 0.2f, 500},
          {"terrain", terrain(60), 0.1f, 1000},    {"block", block, 0.2f, 1000},
          {"slivers", slivers(300), 0.1f, 100},    {"box", box(16), 0.3f, 100},
          {"book", book(5, 12), 0.3f, 60},         {"two", both(bumpy_sphere(3), torus(20, 12), {3, 0, 0}), 1, 100}};
}

// The kernel's result, which keeps its promises.
SimplifyResult sound(const SimplifyInput& input) {
  SimplifyResult result = make_quadric_simplifier()->simplify(input);
  EXPECT_EQ(broken_contract(input, result), "");
  EXPECT_EQ(broken_topology(input, result), "");
  return result;
}

class QuadricKernelOn : public testing::TestWithParam<InstructionSet> {};

TEST_P(QuadricKernelOn, GivesTheSameBytesAsPlain) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor does not have it";
  const auto plain = make_quadric_simplifier(InstructionSet::plain);
  const auto lanes = make_quadric_simplifier(GetParam());
  for (Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const SimplifyInput input = c.mesh.input(c.bound, c.target);
    const SimplifyResult &a = plain->simplify(input), &b = lanes->simplify(input);
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.distance, b.distance);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_LT(a.triangles, input.triangles.size());
  }
}

INSTANTIATE_TEST_SUITE_P(All, QuadricKernelOn, testing::Values(InstructionSet::avx2, InstructionSet::avx512),
                         [](const auto& set) { return set.param == InstructionSet::avx2 ? "avx2" : "avx512"; });

double squared_distance(const SimplifyResult& result, const std::vector<Triangle>& images, Vec3f p) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto at = [&](std::uint32_t v) { return to_double(result.positions[v]); };
  for (const auto& [v] : images)
    nearest = std::min(nearest, nearest_on_triangle(to_double(p), at(v[0]), at(v[1]), at(v[2])).squared_distance);
  return nearest;
}

TEST(QuadricKernel, MeasuresHowFarTheVerticesAreFromTheImages) {
  for (Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const SimplifyInput input = c.mesh.input(c.bound, c.target);
    const auto simplifier = make_quadric_simplifier();
    const SimplifyResult& result = simplifier->simplify(input);
    const std::vector<Triangle> images = image(input, result);
    StarDistance twin;
    twin.reset(images, result.positions);
    double largest = 0, largest_twin = 0;
    for (std::uint32_t v = 0; v < input.positions.size(); ++v) {
      const double measured = result.distance[v];
      const double exact = std::sqrt(squared_distance(result, images, input.positions[v]));
      EXPECT_GE(measured * (1 + 1e-6) + 1e-15, exact) << v;
      largest = std::max(largest, measured);
      largest_twin = std::max(largest_twin, twin.farther(0, input.positions[v], VertexId(result.parent[v])));
    }
    EXPECT_LE(largest, 1.01 * std::sqrt(largest_twin) + 1e-6);
  }
}

// Rough sheets of needles in any direction. Distances in single precision fell short here by up to a part in a
// thousand.
TEST(QuadricKernel, UnderstatesNoDistanceFromNeedles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(0, 1);
  std::normal_distribution<float> rough;
  for (int k = 0; k < 10; ++k) {
    const float width = std::pow(10.0f, -1 - 3 * share(random)), height = std::pow(10.0f, -4 + 3 * share(random));
    const Vec3f along = Vec3f{0.5f + share(random), share(random), share(random)},
                across = {-0.5f, share(random), 0.7f};
    TestMesh mesh = grid(40, 40, false, [&](float u, float v) {
      const Vec3f up = cross(along, across);
      const float z = height * (std::sin(9 * u) * std::cos(3 * v) + 0.01f * rough(random));
      return (u + 0.02f * rough(random)) * along + width * (v + 0.02f * rough(random)) * across + z * up;
    });
    const SimplifyInput input = mesh.input(0.3f, mesh.triangles.size() / 4);
    const auto simplifier = make_quadric_simplifier();
    const SimplifyResult& result = simplifier->simplify(input);
    const std::vector<Triangle> images = image(input, result);
    for (std::uint32_t v = 0; v < input.positions.size(); ++v) {
      const double exact = std::sqrt(squared_distance(result, images, input.positions[v]));
      EXPECT_GE(result.distance[v] * (1 + 1e-6) + 1e-15, exact) << k << " " << v;
    }
  }
}

// The analytic distance from the unbumped sphere stands in for the surface: every vertex is on it at the start.
double sphere_rms(const SimplifyInput& input, const SimplifyResult& result) {
  double sum = 0;
  std::size_t n = 0;
  for (const Triangle& t : image(input, result)) {
    const auto at = [&](int k) { return to_double(result.positions[t.v[k]]); };
    const double off = length((1.0 / 3) * (at(0) + at(1) + at(2))) - 1;
    sum += off * off, ++n;
  }
  return std::sqrt(sum / static_cast<double>(n));
}

TEST(QuadricKernel, IsAsAccurateAsTheExactHeap) {
  TestMesh mesh = bumpy_sphere(5, 0);
  const SimplifyInput input = mesh.input(1, mesh.triangles.size() / 4);
  const double fast = sphere_rms(input, make_quadric_simplifier()->simplify(input));
  const double exact = sphere_rms(input, make_quadric_reference()->simplify(input));
  EXPECT_LT(fast, 1.1 * exact);
}

TEST(QuadricKernel, StopsAtTheVeryTriangle) {
  TestMesh mesh = bumpy_sphere(4);
  for (const std::size_t target : {1024u, 1023u, 512u}) {
    const std::size_t left = make_quadric_simplifier()->simplify(mesh.input(1, target)).triangles;
    EXPECT_EQ(left, target / 2 * 2);
  }
}

TEST(QuadricKernel, SplitsWhatSixteenBitsCannotCount) {
  TestMesh mesh = terrain(300);
  ASSERT_GT(mesh.positions.size(), 65'536u);
  const SimplifyInput input = mesh.input(0.05f, mesh.triangles.size() / 4);
  const auto simplifier = make_quadric_simplifier();
  const SimplifyResult result = simplifier->simplify(input);
  EXPECT_EQ(broken_contract(input, result), "");
  EXPECT_EQ(broken_topology(input, result), "");
  EXPECT_LE(result.triangles, input.target_triangles);
  EXPECT_EQ(simplifier->simplify(input).parent, result.parent);
}

TEST(QuadricKernel, CountsVerticesWithoutTrianglesWhenItSplits) {
  TestMesh mesh = terrain(20);
  mesh.positions.insert(mesh.positions.begin(), 70'000, Vec3f{0.5f, 0.5f, 0.5f});
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v) v += 70'000;
  const SimplifyInput input = mesh.input(0.2f, 200);
  EXPECT_LE(sound(input).triangles, 200u);
}

TEST(QuadricKernel, LeavesCrowdedVerticesAlone) {
  // A fan of 40: its centre has no ring and can neither go nor be arrived at; its rim still shrinks.
  TestMesh mesh;
  mesh.positions.push_back({0, 0, 0});
  constexpr std::uint32_t n = 40;
  for (std::uint32_t k = 0; k < n; ++k) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / n;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.triangles.push_back({{0, k + 1, (k + 1) % n + 1}});
  }
  const SimplifyInput input = mesh.input(0.5f, 20);
  const SimplifyResult result = sound(input);
  EXPECT_EQ(result.parent[0], 0u);
  EXPECT_LE(result.triangles, 20u);
}

TEST(QuadricKernel, CollapsesAlongTheEdgeWhereSurfacesMeet) {
  // Three bumpy pages around one spine, whose vertices are in no fan.
  constexpr std::uint32_t n = 32;
  TestMesh mesh = book(3, n);
  const SimplifyInput input = mesh.input(0.5f, mesh.triangles.size() / 16);
  const SimplifyResult result = sound(input);
  EXPECT_LE(result.triangles, input.target_triangles);
  std::size_t left = 0;
  for (std::uint32_t v = 0; v <= n; ++v) {
    left += result.parent[v] == v;
    const Vec3f& p = result.positions[result.parent[v]];
    EXPECT_LT(p.x * p.x + p.y * p.y, 1e-10f) << v;
  }
  EXPECT_LE(left, n / 2);
}

TEST(QuadricKernel, KeepsTheRimOfDoubledFaces) {
  TestMesh mesh = plane(16);
  const std::vector<Triangle> front = mesh.triangles;
  for (const auto& [v] : front) mesh.triangles.push_back({{v[0], v[2], v[1]}});
  const SimplifyInput input = mesh.input(0.5f, 100);
  const SimplifyResult result = sound(input);
  EXPECT_LE(result.triangles, 100u);
  double area = 0;
  for (const Triangle& t : image(input, result)) {
    const auto at = [&](int k) { return to_double(result.positions[t.v[k]]); };
    area += length(cross(at(1) - at(0), at(2) - at(0))) / 2;
  }
  EXPECT_NEAR(area, 2, 1e-5);
}

TEST(QuadricKernel, TakesSurfacesThatTouchForOnesThatDoNotOnceTheyAreApart) {
  // Two spheres glued at the ends of an edge, and so along it. The edge goes, then the vertex that is left is a pinch.
  TestMesh mesh = both(bumpy_sphere(4), bumpy_sphere(4), {2.2f, 0, 0});
  const Triangle& t = mesh.triangles.front();
  const auto other = static_cast<std::uint32_t>(mesh.positions.size() / 2);
  const std::uint32_t glued[2]{t.v[0], t.v[1]};
  for (Triangle& copy : mesh.triangles)
    for (std::uint32_t& v : copy.v)
      for (const std::uint32_t g : glued) v = v == g + other ? g : v;
  for (const std::uint32_t g : glued) mesh.positions[g].x += 0.05f;
  const Topology before = topology_of(mesh.triangles);
  ASSERT_EQ(before.crowded_edges, 1u);
  ASSERT_EQ(before.pinched_vertices, 2u);
  const SimplifyInput input = mesh.input(3, 16);
  const SimplifyResult result = sound(input);
  const Topology after = topology_of(image(input, result));
  EXPECT_EQ(after.crowded_edges, 0u);
  EXPECT_EQ(after.pinched_vertices, 1u);
  EXPECT_LE(result.triangles, 24u);
}

TEST(QuadricKernel, WorksAtEveryScale) {
  TestMesh mesh = bumpy_sphere(4);
  const auto simplifier = make_quadric_simplifier();
  const SimplifyResult unit = simplifier->simplify(mesh.input(0.25f, 500));
  for (const float scale : {0x1p-60f, 0x1p-20f, 0x1p20f, 0x1p60f}) {
    TestMesh scaled = mesh;
    for (Vec3f& p : scaled.positions) p = scale * p;
    const SimplifyResult& result = simplifier->simplify(scaled.input(0.25f * scale, 500));
    EXPECT_EQ(result.parent, unit.parent) << scale;
  }
}

TEST(QuadricKernel, SurvivesNumbersThatAreNone) {
  TestMesh mesh = bumpy_sphere(3);
  mesh.positions[5].x = std::numeric_limits<float>::quiet_NaN();
  mesh.positions[50].y = std::numeric_limits<float>::infinity();
  const SimplifyInput input = mesh.input(0.25f, 50);
  const SimplifyResult result = make_quadric_simplifier()->simplify(input);
  for (std::size_t v = 0; v < result.parent.size(); ++v) {
    ASSERT_EQ(result.parent[result.parent[v]], result.parent[v]);
    if (result.parent[v] == v && is_finite(input.positions[v])) {
      EXPECT_TRUE(is_finite(result.positions[v]));
    }
  }
  EXPECT_EQ(image(input, result).size(), result.triangles);
}

}  // namespace
}  // namespace lodestone
