#include "core/mesh/generate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/clean.h"

namespace lodestone {
namespace {

// What the topology of a generated surface is, found by brute force: every half-edge in a map.
struct Topology {
  std::size_t boundary_edges = 0;
  bool manifold = true;  // no edge used twice in one direction
  long euler = 0;
};

Topology topology_of(const RawMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> half_edges;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++half_edges[{t.v[k], t.v[(k + 1) % 3]}];
  Topology result;
  std::size_t edges = 0;
  for (const auto& [edge, count] : half_edges) {
    result.manifold &= count == 1;
    const bool paired = half_edges.contains({edge.second, edge.first});
    if (!paired) ++result.boundary_edges;
    if (!paired || edge.first < edge.second) ++edges;
  }
  result.euler =
      static_cast<long>(mesh.positions.size()) - static_cast<long>(edges) + static_cast<long>(mesh.triangles.size());
  return result;
}

// Six times the volume enclosed, positive when triangles are counter-clockwise seen from outside.
double volume_of(const RawMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += dot(mesh.positions[t.v[0]], cross(mesh.positions[t.v[1]], mesh.positions[t.v[2]]));
  return sum;
}

constexpr std::uint64_t sizes[] = {12, 13, 100, 1000, 10'000};

TEST(Generate, ClosedShapesAreManifoldsOfTheirGenus) {
  for (const auto& [shape, euler] :
       {std::pair(Shape::sphere, 2), std::pair(Shape::box, 2), std::pair(Shape::torus, 0)}) {
    for (const std::uint64_t triangles : sizes) {
      const RawMesh mesh = generate_mesh({shape, triangles, 3});
      const Topology topology = topology_of(mesh);
      EXPECT_TRUE(topology.manifold);
      EXPECT_EQ(topology.boundary_edges, 0u);
      EXPECT_EQ(topology.euler, euler);
      EXPECT_GT(volume_of(mesh), 0);
    }
  }
}

TEST(Generate, TerrainIsADiscSeenFromAbove) {
  for (const std::uint64_t triangles : sizes) {
    const RawMesh mesh = generate_mesh({Shape::terrain, triangles, 3});
    const Topology topology = topology_of(mesh);
    EXPECT_TRUE(topology.manifold);
    EXPECT_EQ(topology.euler, 1);
    EXPECT_GT(topology.boundary_edges, 0u);
    for (const Triangle& t : mesh.triangles) {
      const Vec3d a = mesh.positions[t.v[0]];
      EXPECT_GT(cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a).z, 0);
    }
  }
}

TEST(Generate, NothingNeedsRepair) {
  for (const Shape shape : {Shape::sphere, Shape::terrain, Shape::torus, Shape::box}) {
    const RawMesh mesh = generate_mesh({shape, 20'000, 5});
    Repairs repairs;
    const IndexedMesh clean = clean_mesh(mesh, repairs);
    EXPECT_EQ(repairs, Repairs{});
    EXPECT_EQ(clean.triangles, mesh.triangles);
  }
}

TEST(Generate, SizesAreTheNearestThatTheGridAllows) {
  const auto count = [](Shape shape, std::uint64_t n) { return generate_surface({shape, n, 1})->triangle_count(); };
  EXPECT_EQ(count(Shape::sphere, 12), 12u);
  EXPECT_EQ(count(Shape::box, 1200), 1200u);
  EXPECT_EQ(count(Shape::terrain, 12), 12u);
  EXPECT_EQ(count(Shape::torus, 12), 18u);
  for (const Shape shape : {Shape::sphere, Shape::terrain, Shape::torus, Shape::box})
    for (const std::uint64_t n : {1'000'000ul, 64'000'000ul, 200'000'000ul})
      EXPECT_NEAR(count(shape, n) / static_cast<double>(n), 1, 0.004);
}

TEST(Generate, DependsOnTheConfigAlone) {
  for (const Shape shape : {Shape::sphere, Shape::terrain}) {
    const RawMesh mesh = generate_mesh({shape, 5000, 1});
    EXPECT_EQ(mesh.positions, generate_mesh({shape, 5000, 1}).positions);
    EXPECT_NE(mesh.positions, generate_mesh({shape, 5000, 2}).positions);
  }
}

TEST(Generate, AnyRangeIsAPartOfTheWhole) {
  for (const Shape shape : {Shape::sphere, Shape::terrain, Shape::torus, Shape::box}) {
    const GenerateConfig config{shape, 3000, 9};
    const RawMesh mesh = generate_mesh(config);
    const auto surface = generate_surface(config);
    for (std::uint32_t first = 0; first + 7 < surface->vertex_count(); first += 5) {
      std::array<Vec3f, 7> positions;
      surface->positions(first, positions);
      for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(to_double(positions[i]), mesh.positions[first + i]);
      std::array<Triangle, 7> triangles;
      surface->triangles(first, triangles);
      for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(triangles[i], mesh.triangles[first + i]);
    }
  }
}

TEST(Generate, BoxEndsExactlyOnTheFarFacesAlsoWhenNormalised) {
  for (const std::uint64_t triangles : {12ul, 108ul, 1'000ul, 30'000ul}) {
    Repairs repairs;
    const RawMesh raw = generate_mesh({Shape::box, triangles, 1});
    const IndexedMesh mesh = clean_mesh(raw, repairs);
    for (const Vec3f p : mesh.positions)
      EXPECT_TRUE(p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1 || p.z == 0 || p.z == 1);
    EXPECT_NEAR(volume_of(raw), 6, 1e-5);
    EXPECT_EQ(mesh.transform, (Transform{{0, 0, 0}, 1}));
  }
}

TEST(Generate, TorusLiesOnItsTorus) {
  for (const Vec3d p : generate_mesh({Shape::torus, 5000, 1}).positions)
    EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), 0.4, 1e-6);
}

// Fractal, and mild enough for the surface to look like what it is called.
TEST(Generate, DisplacementIsModerate) {
  for (const std::uint32_t seed : {1u, 2u, 77u}) {
    double lowest = 9, highest = 0, sum = 0;
    const RawMesh sphere = generate_mesh({Shape::sphere, 50'000, seed});
    for (const Vec3d p : sphere.positions) {
      lowest = std::min(lowest, length(p));
      highest = std::max(highest, length(p));
      sum += length(p);
    }
    EXPECT_GT(lowest, 0.7);
    EXPECT_LT(highest, 1.3);
    EXPECT_GT(highest - lowest, 0.1);
    EXPECT_NEAR(sum / static_cast<double>(sphere.positions.size()), 1, 0.05);
    lowest = 9, highest = -9;
    for (const Vec3d p : generate_mesh({Shape::terrain, 50'000, seed}).positions) {
      lowest = std::min(lowest, p.z);
      highest = std::max(highest, p.z);
    }
    EXPECT_GT(highest - lowest, 0.08);
    EXPECT_LT(highest - lowest, 0.4);
  }
}

TEST(Generate, RefusesWhatItCannotMake) {
  for (const std::uint64_t triangles : {0ul, 11ul, 200'000'001ul})
    EXPECT_THROW((void)generate_surface({Shape::sphere, triangles, 1}), InputError);
  EXPECT_EQ(shape("torus"), Shape::torus);
  try {
    (void)shape("cone");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("sphere, terrain, torus or box"), std::string::npos);
  }
}

}  // namespace
}  // namespace lodestone
