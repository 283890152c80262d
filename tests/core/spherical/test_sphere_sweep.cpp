// The Newton steps on the sphere against the energy as it is defined, one vertex at a time.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.h"
#include "core/math/orientation.h"
#include "core/spherical/parameterize/sphere_kernel.h"
#include "core/spherical/parameterize/vertex_placement.h"
#include "tests/core/spherical/ring_surface.h"

namespace lodestone::spherical {
namespace {

using test::RingSurface;

Vec3d unit(Vec3d v) { return (1 / length(v)) * v; }

// A sphere with bumps on a sphere with other bumps, coloured.
struct Situation {
  explicit Situation(double guard, int subdivisions = 3) : of(test::sphere_mesh(subdivisions, 0.3)) {
    const std::size_t count = of.mesh.positions.size();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> shift(-0.04, 0.04);
    for (std::size_t v = 0; v < count; ++v) {
      const Vec3d p = of.mesh.transform.to_model(of.mesh.positions[v]);
      surface.push_back(p);
      const Vec3d moved = unit(p) + Vec3d{shift(random), shift(random), shift(random)};
      directions.push_back(snapped(unit(moved)));
    }
    colours.assign(count, absent_colour);
    for (std::size_t v = 0; v < count; ++v) {
      colours[v] = free_colour(of.rings.ring(static_cast<Id>(v)), colours);
      if (lists.size() <= colours[v]) lists.resize(colours[v] + 1u);
      lists[colours[v]].push_back(static_cast<Id>(v));
    }
    weight = guard;
  }

  void sweep(const SphereKernel& kernel, int times) {
    const SphereState state{of.rings, surface, directions, weight, least_area};
    SweepBlock block;
    for (int k = 0; k < times; ++k)
      for (const std::vector<Id>& list : lists) {
        kernel.build(state, list, block);
        kernel.sweep(state, block);
      }
  }

  // By the formula in sphere_kernel.h.
  [[nodiscard]] double energy_at(Id v, Vec3d p) const {
    const progressive::Ring& ring = of.rings.ring(v);
    double sum = 0;
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      const Id i = ring.ids[k], j = ring.ids[ring.next(k)];
      const Vec3d P = surface[v].point(), Q = surface[i].point(), R = surface[j].point();
      const Vec3d q = directions[i].point(), r = directions[j].point();
      const double area = length(cross(Q - P, R - P)) / 2, det = dot(p, cross(q, r));
      if (det <= 0) return 1e300;
      const double n = dot(Q - P, R - P) * dot(q - r, q - r) + dot(P - Q, R - Q) * dot(p - r, p - r) +
                       dot(P - R, Q - R) * dot(p - q, p - q);
      sum += area / 2 * n / (det * det) + weight * area * std::pow(n / (4 * area * area), 3);
    }
    return sum;
  }
  [[nodiscard]] double energy() const {
    double sum = 0;
    for (Id v = 0; v < directions.size(); ++v) sum += energy_at(v, directions[v].point());
    return sum / 3;
  }
  [[nodiscard]] std::size_t flips() const {
    std::size_t count = 0;
    for (const Triangle& t : of.mesh.triangles)
      count += orientation(directions[t.v[0]].point(), directions[t.v[1]].point(), directions[t.v[2]].point()) <= 0;
    return count;
  }

  RingSurface of;
  std::vector<AlignedPoint4d> surface, directions;
  std::vector<std::uint8_t> colours;
  std::vector<std::vector<Id>> lists;
  double weight = 0, least_area = 0;
};

const SphereKernel& plain() { return sphere_kernel(InstructionSet::plain); }

TEST(SphereSweep, LowersTheEnergyAndTurnsNothingOver) {
  for (const double guard : {0.0, 1e-4, 0.1}) {
    Situation s(guard);
    ASSERT_EQ(s.flips(), 0u);
    double before = s.energy();
    const double first = before;
    for (int k = 0; k < 8; ++k) {
      s.sweep(plain(), 1);
      EXPECT_LE(s.energy(), before * (1 + 1e-12));
      before = s.energy();
    }
    EXPECT_LT(before, 0.9 * first);
    EXPECT_EQ(s.flips(), 0u);
  }
}

// Where no step helps any more, no neighbouring point has less energy either.
TEST(SphereSweep, EndsWhereTheEnergyIsLeast) {
  for (const double guard : {0.0, 1e-2}) {
    Situation s(guard, 2);
    s.sweep(plain(), 600);
    for (Id v = 0; v < s.directions.size(); ++v) {
      const Vec3d p = s.directions[v].point();
      const double here = s.energy_at(v, p);
      for (const Vec3d way : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
        for (const double step : {-1e-4, 1e-4}) EXPECT_GT(s.energy_at(v, unit(p + step * way)), here * (1 - 1e-9));
    }
  }
}

TEST(SphereSweep, EveryInstructionSetGivesTheSameBytes) {
  if (!is_available(InstructionSet::avx2)) GTEST_SKIP() << "no AVX2 here";
  Situation one(1e-4), two(1e-4);
  one.sweep(plain(), 5);
  two.sweep(sphere_kernel(InstructionSet::avx2), 5);
  for (std::size_t v = 0; v < one.directions.size(); ++v)
    ASSERT_EQ(one.directions[v].point(), two.directions[v].point());
}

// A vertex gives the same with others beside it, and alone.
TEST(SphereSweep, LanesDoNotMix) {
  Situation together(1e-4), alone(1e-4);
  together.sweep(plain(), 1);
  const SphereState state{alone.of.rings, alone.surface, alone.directions, alone.weight, alone.least_area};
  SweepBlock block;
  for (const std::vector<Id>& list : alone.lists)
    for (const Id v : list) {
      plain().build(state, std::span(&v, 1), block);
      plain().sweep(state, block);
    }
  for (std::size_t v = 0; v < alone.directions.size(); ++v)
    ASSERT_EQ(together.directions[v].point(), alone.directions[v].point());
}

// Without area they are measured as small equilateral triangles.
TEST(SphereSweep, SurfacesWithoutAreaAreSpreadEvenly) {
  Situation s(1e-4);
  for (AlignedPoint4d& p : s.surface) p = Vec3d{};
  s.least_area = 12.56 / static_cast<double>(s.of.mesh.triangles.size());
  s.sweep(plain(), 30);
  EXPECT_EQ(s.flips(), 0u);
  double least = 1, most = 0;
  for (const Triangle& t : s.of.mesh.triangles) {
    const Vec3d a = s.directions[t.v[0]].point(), b = s.directions[t.v[1]].point(), c = s.directions[t.v[2]].point();
    least = std::min(least, dot(a, cross(b, c))), most = std::max(most, dot(a, cross(b, c)));
  }
  EXPECT_LT(most, 2.5 * least);
}

TEST(VertexPlacement, NewVerticesAreInTheKernelsOfTheirRings) {
  Situation s(0);
  for (Id v = 0; v < s.directions.size(); ++v) {
    const progressive::Ring& ring = s.of.rings.ring(v);
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      // As if the vertex had collapsed into this neighbour: possible if that sees the whole ring.
      const Vec3d target = s.directions[ring.ids[k]].point();
      bool sees = true;
      for (std::uint32_t m = ring.next(k); m != ring.previous(k); m = ring.next(m))
        sees = sees &&
               orientation(target, s.directions[ring.ids[m]].point(), s.directions[ring.ids[ring.next(m)]].point()) > 0;
      if (!sees) continue;
      const AlignedPoint4d before = s.directions[v];
      ASSERT_TRUE(place_vertex(v, ring.ids[k], ring, s.directions));
      ASSERT_EQ(s.flips(), 0u);
      s.directions[v] = before;
    }
  }
}

TEST(VertexPlacement, WhereTheRingHasNoKernelNothingIsPlaced) {
  Situation s(0);
  const progressive::Ring& ring = s.of.rings.ring(50);
  s.directions[ring.ids[0]] = snapped(-1.0 * s.directions[ring.ids[2]].point());
  EXPECT_FALSE(place_vertex(50, ring.ids[0], ring, s.directions));
}

TEST(VertexPlacement, ColoursRunOutAtLast) {
  for (const std::uint32_t count : {3u, 64u, 70u, 254u, 255u}) {
    IndexedMesh mesh;
    for (std::uint32_t v = 0; v <= count; ++v) mesh.positions.push_back({static_cast<float>(v), 0, 0});
    for (std::uint32_t v = 1; v <= count; ++v) mesh.triangles.push_back({{0, v, v % count + 1}});
    const RingSurface fan(mesh);
    std::vector<std::uint8_t> colours(count + 1);
    for (std::uint32_t v = 1; v <= count; ++v) colours[v] = static_cast<std::uint8_t>(v - 1);
    EXPECT_EQ(free_colour(fan.rings.ring(0), colours), count);
    if (count > 3) {
      colours[3] = 0;
      EXPECT_EQ(free_colour(fan.rings.ring(0), colours), 2);
    }
  }
}

TEST(VertexPlacement, ColoursDifferFromThoseOfTheNeighbours) {
  const Situation s(0);
  for (Id v = 0; v < s.colours.size(); ++v)
    for (const Id x : s.of.rings.ring(v).neighbours()) ASSERT_NE(s.colours[v], s.colours[x]);
  EXPECT_LE(s.lists.size(), 7u);
}

}  // namespace
}  // namespace lodestone::spherical
