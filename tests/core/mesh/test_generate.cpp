// Generated surfaces: connectivity by brute force, determinism, ranges.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/base/error.h"
#include "core/mesh/generate.h"

namespace lodestone {
namespace {

struct Topology {
  std::size_t unpaired = 0, edges = 0, used = 0;
  [[nodiscard]] long euler(std::size_t triangles) const {
    return static_cast<long>(used) - static_cast<long>(edges) + static_cast<long>(triangles);
  }
};

Topology topology(const RawMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> half_edges;
  std::set<std::uint32_t> used;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(t.v[k], mesh.positions.size());
      ++half_edges[{t.v[k], t.v[(k + 1) % 3]}];
      used.insert(t.v[k]);
    }
  Topology result{0, 0, used.size()};
  for (const auto& [edge, count] : half_edges) {
    EXPECT_EQ(count, 1);
    const bool paired = half_edges.contains({edge.second, edge.first});
    result.unpaired += !paired;
    result.edges += !paired || edge.first < edge.second;
  }
  return result;
}

double signed_volume(const RawMesh& mesh) {
  double volume = 0;
  for (const Triangle& t : mesh.triangles)
    volume += dot(mesh.positions[t.v[0]], cross(mesh.positions[t.v[1]], mesh.positions[t.v[2]])) / 6;
  return volume;
}

TEST(Generate, ClosedSurfacesAreClosedAndFaceOutward) {
  for (const std::uint64_t n : {12u, 48u, 500u, 5000u}) {
    for (const auto& [shape, euler] : std::map<Shape, long>{{Shape::sphere, 2}, {Shape::box, 2}, {Shape::torus, 0}}) {
      const RawMesh mesh = generate_mesh({shape, n, 3});
      const Topology t = topology(mesh);
      EXPECT_EQ(t.unpaired, 0u);
      EXPECT_EQ(t.used, mesh.positions.size());
      EXPECT_EQ(t.euler(mesh.triangles.size()), euler) << static_cast<int>(shape) << " " << n;
      EXPECT_GT(signed_volume(mesh), 0) << static_cast<int>(shape) << " " << n;
    }
  }
}

TEST(Generate, TerrainIsADiskFacingUp) {
  const RawMesh mesh = generate_mesh({Shape::terrain, 800, 1});
  EXPECT_EQ(mesh.triangles.size(), 800u);
  EXPECT_EQ(topology(mesh).unpaired, 80u);
  EXPECT_EQ(topology(mesh).euler(800), 1);
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t.v[0]];
    EXPECT_GT(cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a).z, 0);
  }
}

TEST(Generate, BoxFillsTheUnitCubeExactly) {
  const RawMesh mesh = generate_mesh({Shape::box, 12 * 49, 1});
  EXPECT_EQ(mesh.triangles.size(), 12u * 49);
  for (const Vec3d p : mesh.positions) {
    EXPECT_TRUE(p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1 || p.z == 0 || p.z == 1);
    EXPECT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1);
  }
  EXPECT_NEAR(signed_volume(mesh), 1, 1e-6);
}

// Every box is closed and faces outward, and together they are larger than their ball: they overlap.
TEST(Generate, PileIsOverlappingBoxes) {
  const RawMesh mesh = generate_mesh({Shape::pile, 12 * 500, 1});
  EXPECT_EQ(mesh.triangles.size(), 12u * 500);
  EXPECT_EQ(topology(mesh).unpaired, 0u);
  double box_volume = 0;
  for (std::size_t box = 0; box < 500; ++box) {
    RawMesh one;
    one.positions = mesh.positions;
    one.triangles.assign(mesh.triangles.begin() + 12 * static_cast<std::ptrdiff_t>(box),
                         mesh.triangles.begin() + 12 * static_cast<std::ptrdiff_t>(box + 1));
    const double volume = signed_volume(one);
    EXPECT_GT(volume, 0);
    box_volume += volume;
  }
  constexpr double ball = 4.18879;
  EXPECT_GT(box_volume, 2 * ball);
  EXPECT_LT(box_volume, 5 * ball);
  for (const Vec3d p : mesh.positions) EXPECT_LT(length(p), 1.4);
}

TEST(Generate, CountsComeNearTheWish) {
  for (const Shape s : {Shape::sphere, Shape::terrain, Shape::torus, Shape::box, Shape::pile})
    for (const std::uint64_t n : {100'000ull, 1'000'000ull, 64'000'000ull, 128'000'000ull})
      EXPECT_NEAR(static_cast<double>(GeneratedSurface({s, n, 1}).triangle_count()), static_cast<double>(n),
                  0.01 * static_cast<double>(n));
}

TEST(Generate, SeedChangesShapeNotConnectivity) {
  const RawMesh a = generate_mesh({Shape::sphere, 1000, 1}), b = generate_mesh({Shape::sphere, 1000, 2});
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_NE(a.positions, b.positions);
  EXPECT_EQ(a.positions, generate_mesh({Shape::sphere, 1000, 1}).positions);
}

TEST(Generate, RefusesNumbersOutOfRange) {
  EXPECT_THROW((void)generate_mesh({Shape::sphere, 11, 1}), InputError);
  EXPECT_THROW(GeneratedSurface({Shape::sphere, 3'000'000'000, 1}), InputError);
  EXPECT_THROW((void)shape_named("cube"), InputError);
}

}  // namespace
}  // namespace lodestone
