// The measure of maps to the sphere against an integration of the central projection.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/spherical/parameterize/sphere_measure.h"
#include "tests/test_meshes.h"

namespace lodestone::spherical {
namespace {

struct Mapped {
  std::vector<Vec3d> positions, directions;
  std::vector<Triangle> triangles;
};

// A sphere, mapped to itself after its points were moved.
template <class Move>
Mapped moved_sphere(int subdivisions, const Move& move) {
  const IndexedMesh mesh = test::sphere_mesh(subdivisions, 0);
  Mapped out;
  out.triangles = mesh.triangles;
  for (const Vec3f p : mesh.positions) {
    const Vec3d from_centre = mesh.transform.to_model(p), to = move(from_centre);
    out.positions.push_back(from_centre);
    out.directions.push_back((1 / length(to)) * to);
  }
  return out;
}

// Half the squared norm of the derivative of the way from the sphere to the surface, where the central projection onto
// the chords meets barycentric coordinates (s, t).
double half_squared_norm(const Mapped& m, const Triangle& triangle, double s, double t) {
  const auto at = [&](const std::vector<Vec3d>& p, std::size_t k) { return p[triangle.v[k]]; };
  const Vec3d e1 = at(m.directions, 1) - at(m.directions, 0), e2 = at(m.directions, 2) - at(m.directions, 0);
  const Vec3d f1 = at(m.positions, 1) - at(m.positions, 0), f2 = at(m.positions, 2) - at(m.positions, 0);
  const Vec3d chord = at(m.directions, 0) + s * e1 + t * e2, normal = cross(e1, e2);
  const Vec3d q = (1 / length(chord)) * chord;
  const Vec3d side = std::abs(q.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d x = (1 / length(cross(q, side))) * cross(q, side), y = cross(q, x);
  double sum = 0;
  for (const Vec3d tangent : {x, y}) {
    const Vec3d on_chord = length(chord) * (tangent - (dot(tangent, normal) / dot(q, normal)) * q);
    const double size = dot(normal, normal);
    const double ds = dot(cross(on_chord, e2), normal) / size, dt = dot(cross(e1, on_chord), normal) / size;
    const Vec3d image = ds * f1 + dt * f2;
    sum += dot(image, image) / 2;
  }
  return sum;
}

double integrated_efficiency(const Mapped& m) {
  constexpr int steps = 12;
  double area = 0, stretch = 0;
  for (const Triangle& t : m.triangles) {
    const Vec3d p = m.positions[t.v[0]];
    const double size = length(cross(m.positions[t.v[1]] - p, m.positions[t.v[2]] - p)) / 2;
    area += size;
    // The centres of the small triangles.
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j) {
        stretch += size / (steps * steps) * half_squared_norm(m, t, (i + 1.0 / 3) / steps, (j + 1.0 / 3) / steps);
        if (i + j + 1 < steps)
          stretch += size / (steps * steps) * half_squared_norm(m, t, (i + 2.0 / 3) / steps, (j + 2.0 / 3) / steps);
      }
  }
  return area * area / (4 * std::numbers::pi * stretch);
}

SphereSums measured(const Mapped& m) { return measure_sphere_map(m.positions, m.triangles, m.directions); }

TEST(SphereMeasure, TheSphereOnItselfIsNearlyPerfect) {
  const SphereSums sums = measured(moved_sphere(5, [](Vec3d p) { return p; }));
  EXPECT_GT(sums.efficiency(), 0.999);
  EXPECT_LT(sums.efficiency(), 1.0001);
  EXPECT_NEAR(sums.area, 4 * std::numbers::pi, 0.02);
  EXPECT_EQ(sums.flips, 0u);
  EXPECT_EQ(sums.slivers, 0u);
}

TEST(SphereMeasure, AgreesWithTheIntegralOfTheCentralProjection) {
  const auto stretched = [](double factor) { return [=](Vec3d p) { return Vec3d{p.x, p.y, factor * p.z}; }; };
  const auto wave = [](Vec3d p) { return p + 0.2 * Vec3d{std::sin(5 * p.y), std::cos(4 * p.z), std::sin(6 * p.x)}; };
  for (const Mapped& m : {moved_sphere(4, stretched(3)), moved_sphere(4, stretched(0.1)), moved_sphere(4, wave)})
    EXPECT_NEAR(measured(m).efficiency(), integrated_efficiency(m), 0.002);
}

TEST(SphereMeasure, DoesNotDependOnTheScale) {
  const Mapped m = moved_sphere(3, [](Vec3d p) { return Vec3d{p.x, 2 * p.y, p.z}; });
  Mapped scaled = m;
  for (Vec3d& p : scaled.positions) p = 1000.0 * p + Vec3d{5, 6, 7};
  EXPECT_NEAR(measured(scaled).efficiency(), measured(m).efficiency(), 1e-9);
}

TEST(SphereMeasure, CountsTrianglesTurnedOver) {
  Mapped m = moved_sphere(3, [](Vec3d p) { return p; });
  const Triangle t = m.triangles[10];
  std::swap(m.directions[t.v[0]], m.directions[t.v[1]]);
  EXPECT_GT(measured(m).flips, 0u);
  for (Vec3d& d : m.directions) d = -1.0 * d;
  EXPECT_GT(measured(m).flips, m.triangles.size() / 2);
}

TEST(SphereMeasure, CountsSliversOnEitherSide) {
  const Mapped m = moved_sphere(5, [](Vec3d p) { return Vec3d{p.x, p.y, 0.0001 * p.z}; });
  EXPECT_GT(measured(m).slivers, 0u);
  EXPECT_EQ(measured(m).surface_slivers, 0u);
  const Mapped other{m.directions, m.positions, m.triangles};
  EXPECT_EQ(measured(other).slivers, 0u);
  EXPECT_EQ(measured(other).surface_slivers, measured(m).slivers);
}

TEST(SphereMeasure, TrianglesWithoutAreaCountNothing) {
  Mapped m = moved_sphere(2, [](Vec3d p) { return p; });
  for (Vec3d& p : m.positions) p = {};
  EXPECT_EQ(measured(m).efficiency(), 0);
  EXPECT_EQ(SphereSums{}.efficiency(), 0);
}

}  // namespace
}  // namespace lodestone::spherical
