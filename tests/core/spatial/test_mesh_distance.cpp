// Distances between meshes against closed forms, brute force, and themselves under every scheduler.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/base/error.h"
#include "core/spatial/mesh_distance.h"
#include "core/spatial/point_triangle.h"
#include "core/spatial/surface_samples.h"
#include "core/spatial/triangle_bvh.h"
#include "parallel/mesh/compare.h"
#include "tests/core/hierarchy/lattice_meshes.h"

namespace lodestone {
namespace {

constexpr Vec3d a{0, 0, 0}, b{4, 0, 0}, c{0, 3, 0};

TEST(NearestOnTriangle, FindsFaceEdgesAndCorners) {
  struct Case {
    Vec3d from, to;
  };
  for (const Case& k : {Case{{1, 1, 2}, {1, 1, 0}}, Case{{1, 1, -5}, {1, 1, 0}},    // face
                        Case{{2, -1, 1}, {2, 0, 0}}, Case{{-3, 1, 0}, {0, 1, 0}},   // edges ab and ca
                        Case{{2 + 3, 1.5 + 4, 7}, {2, 1.5, 0}},                     // edge bc, along its normal (3, 4)
                        Case{{-1, -2, 3}, {0, 0, 0}}, Case{{9, -1, 0}, {4, 0, 0}},  // corners
                        Case{{-1, 9, 1}, {0, 3, 0}}, Case{{4, 0, 0}, {4, 0, 0}}}) {
    for (int turn = 0; turn < 3; ++turn) {
      const NearestPoint found = turn == 0   ? nearest_on_triangle(k.from, a, b, c)
                                 : turn == 1 ? nearest_on_triangle(k.from, b, c, a)
                                             : nearest_on_triangle(k.from, c, a, b);
      EXPECT_NEAR(length(found.point - k.to), 0, 1e-14);
      EXPECT_NEAR(std::sqrt(found.squared_distance), length(k.from - k.to), 1e-14);
    }
  }
}

TEST(NearestOnTriangle, TakesSegmentsPointsAndSlivers) {
  EXPECT_EQ(nearest_on_triangle({1, 2, 2}, a, a, a).squared_distance, 9);
  EXPECT_EQ(nearest_on_triangle({2, 5, 0}, a, b, a).squared_distance, 25);
  EXPECT_EQ(nearest_on_triangle({6, 0, 0}, a, b, {2, 0, 0}).squared_distance, 4);
  // Collinear within rounding: the normal is noise, the distance is that to the segment.
  const Vec3d p{0.1, 0.1, 0.1}, q{0.7, 0.7, 0.7}, middle{0.3, 0.3 + 1e-16, 0.3 - 3e-17};
  const Vec3d off{0.3 + 0.5, 0.3 - 0.5, 0.3};
  EXPECT_NEAR(std::sqrt(nearest_on_triangle(off, p, q, middle).squared_distance), std::sqrt(0.5), 1e-12);
}

// Points in a sliver are at no distance from it, however thin it is; its edges are farther.
TEST(NearestOnTriangle, SliversHaveAnInside) {
  const Vec3d p{0.1, 0.2, 0.3}, q{0.9, 0.5, 0.6}, across{-0.3, 0.8, 0};
  for (const double height : {1e-5, 1e-6, 1e-8, 1e-10, 1e-11}) {
    const Vec3d r = 0.4 * p + 0.6 * q + height * across;
    for (const Vec3d weights : {Vec3d{0.3, 0.3, 0.4}, Vec3d{0.2, 0.4, 0.4}, Vec3d{0.01, 0.02, 0.97}}) {
      const Vec3d inside = weights.x * p + weights.y * q + weights.z * r;
      EXPECT_LT(std::sqrt(nearest_on_triangle(inside, p, q, r).squared_distance), 3e-16) << height;
      EXPECT_LT(std::sqrt(nearest_on_triangle(inside, r, p, q).squared_distance), 3e-16) << height;
    }
  }
}

std::mt19937 generator(unsigned seed) { return std::mt19937(seed); }
Vec3d random_point(std::mt19937& random, double extent = 1) {
  const auto next = [&] { return extent * (static_cast<double>(random()) / 4294967295.0); };
  const double x = next(), y = next();
  return {x, y, next()};
}

// No point of a fine lattice on the triangle is nearer, and the answer is that of one of its points.
TEST(NearestOnTriangle, AgreesWithALatticeOfPoints) {
  auto random = generator(7);
  for (int round = 0; round < 200; ++round) {
    const Vec3d u = random_point(random), v = random_point(random), w = random_point(random, round % 3 ? 1 : 0.01);
    const Vec3d from = random_point(random, 2);
    double least = 1e9;
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; i + j <= 40; ++j)
        least = std::min(least, length(from - (u + (i / 40.0) * (v - u) + (j / 40.0) * (w - u))));
    const NearestPoint found = nearest_on_triangle(from, u, v, w);
    const double distance = std::sqrt(found.squared_distance);
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 2.0 / 40);
    EXPECT_NEAR(distance, length(from - found.point), 1e-12);
    EXPECT_NEAR(nearest_on_triangle(found.point, u, v, w).squared_distance, 0, 1e-20);
  }
}

struct Soup {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};

Soup random_soup(std::size_t triangles, unsigned seed, double size) {
  auto random = generator(seed);
  Soup soup;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3d at = random_point(random);
    for (int k = 0; k < 3; ++k) soup.positions.push_back(at + random_point(random, size));
    soup.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  return soup;
}

void expect_nearest(const Soup& soup, unsigned seed) {
  const TriangleBvh bvh(soup.positions, soup.triangles);
  auto random = generator(seed);
  std::uint32_t hint = TriangleBvh::no_hint;
  for (int round = 0; round < 200; ++round) {
    const Vec3d p = random_point(random, 1.5);
    double least = 1e300;
    for (const Triangle& t : soup.triangles)
      least =
          std::min(least, nearest_on_triangle(p, soup.positions[t.v[0]], soup.positions[t.v[1]], soup.positions[t.v[2]])
                              .squared_distance);
    for (const std::uint32_t start : {TriangleBvh::no_hint, hint}) {
      const TriangleBvh::Nearest found = bvh.nearest(p, start);
      EXPECT_NEAR(found.squared_distance, least, 1e-14);
      const auto& v = soup.triangles[bvh.triangle(found.slot)].v;
      EXPECT_EQ(
          nearest_on_triangle(p, soup.positions[v[0]], soup.positions[v[1]], soup.positions[v[2]]).squared_distance,
          found.squared_distance);
    }
    hint = bvh.nearest(p).slot;
  }
}

TEST(TriangleBvh, AgreesWithBruteForce) {
  for (const std::size_t count : {1u, 2u, 4u, 5u, 9u, 1000u})
    for (const double size : {0.02, 1.0}) expect_nearest(random_soup(count, static_cast<unsigned>(count), size), 3);
}

TEST(TriangleBvh, TakesEqualAndDegenerateTriangles) {
  Soup equal = random_soup(1, 5, 1);
  equal.triangles.resize(100, equal.triangles[0]);
  expect_nearest(equal, 1);
  Soup points = random_soup(50, 6, 0);
  expect_nearest(points, 2);
  Soup one_point{{{0.5, 0.5, 0.5}}, std::vector<Triangle>(7, Triangle{{0, 0, 0}})};
  expect_nearest(one_point, 3);
}

// By the signs of the volumes that the ray makes with the edges; infinity: not.
double meet_triangle(Vec3d from, Vec3d direction, double least, Vec3d u, Vec3d v, Vec3d w) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const auto side = [&](Vec3d p, Vec3d q) { return dot(direction, cross(p - from, q - from)); };
  const double uv = side(u, v), vw = side(v, w), wu = side(w, u);
  if (!((uv > 0 && vw > 0 && wu > 0) || (uv < 0 && vw < 0 && wu < 0))) return never;
  const Vec3d normal = cross(v - u, w - u);
  const double t = dot(u - from, normal) / dot(direction, normal);
  return t >= least ? t : never;
}

TEST(TriangleBvh, MeetsWhatARayMeets) {
  for (const std::size_t count : {1u, 5u, 300u}) {
    const Soup soup = random_soup(count, static_cast<unsigned>(count), 0.4);
    const TriangleBvh bvh(soup.positions, soup.triangles);
    auto random = generator(4);
    int met = 0;
    for (int round = 0; round < 2000; ++round) {
      const Vec3d from = random_point(random, 1.5);
      Vec3d direction = random_point(random) - Vec3d{0.5, 0.5, 0.5};
      if (round % 5 == 0) direction = {0, 0, round % 2 == 0 ? 1.0 : -1.0};
      const double least = round % 3 == 0 ? 0.5 : 0;
      double expected = std::numeric_limits<double>::infinity();
      for (const Triangle& t : soup.triangles)
        expected = std::min(expected, meet_triangle(from, direction, least, soup.positions[t.v[0]],
                                                    soup.positions[t.v[1]], soup.positions[t.v[2]]));
      const double found = bvh.meet(from, direction, least),
                   any = bvh.meet(from, direction, least, TriangleBvh::Hit::any_will_do);
      EXPECT_EQ(std::isfinite(found), std::isfinite(expected));
      EXPECT_EQ(std::isfinite(any), std::isfinite(expected));
      if (!std::isfinite(expected)) continue;
      EXPECT_NEAR(found, expected, 1e-9 * (1 + expected));
      EXPECT_GE(any, found);
      ++met;
    }
    EXPECT_GT(met, 10);
  }
  // Along the faces of all boxes, from a point in one of them.
  const std::vector<Vec3d> flat_square{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const TriangleBvh flat(flat_square, std::vector<Triangle>{{{0, 1, 2}}, {{0, 2, 3}}});
  EXPECT_EQ(flat.meet({0.25, 0.5, 0}, {0, 0, 1}, 0), 1);
  EXPECT_TRUE(std::isinf(flat.meet({0.25, 0.5, 1}, {0, 0, 1}, 1e-6)));  // itself
  EXPECT_TRUE(std::isinf(flat.meet({0.25, 0.5, 2}, {0, 0, 1}, 0)));
}

RawMesh square(double z, double size = 1) {
  RawMesh mesh;
  mesh.positions = {{0, 0, z}, {size, 0, z}, {size, size, z}, {0, size, z}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  return mesh;
}

RawMesh sphere(double radius, int times = 4, Vec3d centre = {}) {
  const IndexedMesh unit = test::bumpy_sphere(times);
  RawMesh mesh;
  mesh.triangles = unit.triangles;
  for (const Vec3f p : unit.positions) {
    const Vec3d direction = to_double(p) - Vec3d{0.5, 0.5, 0.5};
    mesh.positions.push_back(centre + (radius / length(direction)) * direction);
  }
  return mesh;
}

TEST(SurfaceSamples, FollowTheAreaAndLieOnTheirTriangles) {
  // Areas 1, 3 and 0: 100 points fall 25, 75 and none; the last vertex is of no triangle.
  const std::vector<Vec3d> positions{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 3, 0}, {9, 9, 9}};
  const std::vector<Triangle> triangles{{{0, 1, 2}}, {{1, 1, 2}}, {{1, 3, 2}}};
  const SurfaceSamples samples(positions, triangles, 100);
  EXPECT_EQ(samples.vertices(), 4u);
  ASSERT_EQ(samples.size(), 104u);
  std::vector<Vec3d> points;
  samples.take(0, samples.size(), points);
  int in_first = 0;
  for (std::size_t i = samples.vertices(); i < points.size(); ++i) {
    EXPECT_EQ(points[i].z, 0);
    EXPECT_TRUE(points[i].x >= 0 && points[i].y >= 0);
    in_first += points[i].x / 2 + points[i].y <= 1 + 1e-12;  // the first point is on the common edge
  }
  EXPECT_EQ(in_first, 25);
  // Any cut gives the same points.
  std::vector<Vec3d> part, joined;
  for (std::uint64_t begin = 0; begin < samples.size(); begin += 7) {
    samples.take(begin, std::min<std::uint64_t>(begin + 7, samples.size()), part);
    joined.insert(joined.end(), part.begin(), part.end());
  }
  EXPECT_EQ(joined, points);
}

TEST(SurfaceSamples, HaveVerticesOnlyWhereThereIsNoArea) {
  const std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<Triangle> triangles{{{0, 1, 2}}};
  EXPECT_EQ(SurfaceSamples(positions, triangles, 50).size(), 3u);
}

TEST(CompareMeshes, MeasuresTheOffsetOfPlanes) {
  const MeshDistance result = compare_meshes(square(0), square(0.25));
  EXPECT_NEAR(result.diagonal, std::sqrt(2), 1e-15);
  for (const DirectedDistance& d : {result.forward, result.backward}) {
    EXPECT_EQ(d.samples, 10'004u);
    for (const double value : {d.max, d.rms, d.mean, d.p99}) EXPECT_NEAR(value, 0.25, 1e-15);
  }
}

// From the large square outside the small one distances grow to the corner's: all four figures in closed form.
TEST(CompareMeshes, IsDirected) {
  const MeshDistance result = compare_meshes(square(0, 2), square(0, 1), {.area_points = 200'000});
  EXPECT_NEAR(result.backward.max, 0, 1e-15);
  EXPECT_NEAR(result.forward.max, std::sqrt(2), 1e-12);
  // Quarter of the area at distance 0, two quarters at u, one at sqrt(u^2 + v^2), u and v uniform in [0, 1].
  EXPECT_NEAR(result.forward.mean, 0.5 * 0.5 + 0.25 * (std::sqrt(2) + std::log(1 + std::sqrt(2))) / 3, 1e-4);
  EXPECT_NEAR(result.forward.rms, std::sqrt(0.5 / 3 + 0.25 * 2 / 3), 1e-4);
  // 1 % of the area is 0.04, beyond the circle about the small square's corner that leaves 0.04 of the unit square.
  const auto outside = [](double r) {  // area of the unit square beyond radius r in [1, sqrt 2] of a corner
    const double leg = std::sqrt(r * r - 1), angle = std::acos(0.0) - 2 * std::acos(1 / r);
    return 1 - leg - 0.5 * r * r * angle;
  };
  EXPECT_NEAR(outside(result.forward.p99), 0.04, 4e-4);
}

// Concentric polyhedra: from each point the other one is (s - 1) times the apothem away at least, the radius at most.
TEST(CompareMeshes, MeasuresConcentricSpheres) {
  const double radius = 2, scale = 1.1;
  const RawMesh inner = sphere(radius), outer = sphere(radius * scale);
  double apothem = radius;
  for (const Triangle& t : inner.triangles) {
    const Vec3d u = inner.positions[t.v[0]], v = inner.positions[t.v[1]], w = inner.positions[t.v[2]];
    const Vec3d normal = cross(v - u, w - u);
    apothem = std::min(apothem, std::abs(dot(u, normal)) / length(normal));
  }
  const MeshDistance result = compare_meshes(inner, outer);
  for (const double value : {result.forward.max, result.forward.rms, result.forward.mean, result.forward.p99}) {
    EXPECT_GE(value, (scale - 1) * apothem * (1 - 1e-12));
    EXPECT_LE(value, (scale - 1) * radius * (1 + 1e-12));
  }
  EXPECT_NEAR(result.backward.max, (scale - 1) * radius, 1e-12);  // from the corners of the outer to those of the inner
  EXPECT_GE(result.backward.mean, (scale - 1) * apothem * (1 - 1e-12));
}

TEST(CompareMeshes, IsZeroForTheSameSurface) {
  const RawMesh mesh = sphere(3);
  const MeshDistance result = compare_meshes(mesh, mesh);
  EXPECT_LT(result.forward.max, 1e-14);
  EXPECT_LT(result.backward.p99, 1e-14);
}

TEST(CompareMeshes, AgreesWithBruteForceOnEveryFigure) {
  const RawMesh p = sphere(1, 3), q = sphere(1.3, 2, {0.2, 0.1, 0});
  const CompareConfig config{.area_points = 2000};
  const MeshDistance fast = compare_meshes(p, q, config), slow = compare_meshes_brute_force(p, q, config);
  EXPECT_EQ(fast.diagonal, slow.diagonal);
  const auto near = [](const DirectedDistance& u, const DirectedDistance& v) {
    EXPECT_EQ(u.samples, v.samples);
    EXPECT_NEAR(u.max, v.max, 1e-14);
    EXPECT_NEAR(u.rms, v.rms, 1e-14);
    EXPECT_NEAR(u.mean, v.mean, 1e-14);
    EXPECT_NEAR(u.p99, v.p99, 1e-14);
  };
  near(fast.forward, slow.forward);
  near(fast.backward, slow.backward);
}

TEST(CompareMeshes, GivesTheSameBytesForAnyNumberOfThreads) {
  const RawMesh p = sphere(1, 5), q = sphere(1.05, 4, {0.02, 0.01, 0});
  const MeshDistance expected = compare_meshes(p, q);
  for (const int threads : {1, 2, 3, 7}) {
    const auto scheduler = make_tbb_scheduler(threads);
    const MeshDistance result = compare_meshes(p, q, {}, *scheduler);
    EXPECT_EQ(std::memcmp(&result, &expected, sizeof(result)), 0) << threads;
  }
  const auto serial = make_serial_scheduler();
  const MeshDistance result = compare_meshes(p, q, {}, *serial);
  EXPECT_EQ(std::memcmp(&result, &expected, sizeof(result)), 0);
}

TEST(CompareMeshes, BearsOffsetsAndScales) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const Vec3d offset{1e7 * scale, -1e7 * scale, 3e6 * scale};
    const RawMesh p = sphere(scale, 4, offset), q = sphere(1.5 * scale, 4, offset);
    const MeshDistance result = compare_meshes(p, q);
    EXPECT_NEAR(result.backward.max / scale, 0.5, 1e-8);
    EXPECT_GT(result.forward.mean / scale, 0.49);
  }
}

TEST(CompareMeshes, TakesMeshesWithoutArea) {
  RawMesh point;
  point.positions = {{1, 1, 1}};
  point.triangles = {{{0, 0, 0}}};
  const MeshDistance same = compare_meshes(point, point);
  EXPECT_EQ(same.diagonal, 0);
  EXPECT_EQ(same.forward.max, 0);
  EXPECT_NEAR(compare_meshes(point, square(0)).forward.mean, 1, 1e-15);
}

TEST(CompareMeshes, RefusesEmptyAndNonFiniteMeshesButNotUnreferencedVertices) {
  EXPECT_THROW((void)compare_meshes(RawMesh{}, square(0)), InputError);
  EXPECT_THROW((void)compare_meshes(square(0), RawMesh{}), InputError);
  RawMesh bad = square(0);
  bad.positions[2].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)compare_meshes(square(0), bad), InputError);
  RawMesh stray = square(0);
  stray.positions.push_back({HUGE_VAL, 0, 0});
  EXPECT_EQ(compare_meshes(stray, square(0)).forward.max, 0);
}

}  // namespace
}  // namespace lodestone
