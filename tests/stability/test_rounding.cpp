// Rounding of the kernels against exact figures, and the tolerances that the program derives from it. With u = 2^-53 in
// double and 2^-24 in float, and lengths of at most sqrt(3), the diagonal of the unit cube.
#include <gtest/gtest.h>

#include "core/hierarchy/construct/cell_error.h"
#include "core/math/orientation.h"
#include "core/simplify/simplifiers.h"
#include "experiments/metrics/pictures/flip.h"
#include "experiments/metrics/pops/pops.h"
#include "tests/experiments/metrics/naive_images.h"
#include "tests/stability/kernel_errors.h"

namespace lodestone::test {
namespace {

constexpr double u64 = 0x1p-53, u32 = 0x1p-24;
const double diagonal = std::sqrt(3.0);

// Coordinates of the point found are off the triangle by two roundings of each edge, two sums and the point itself: six
// u and sqrt(3) times that in space. Differences, squares, sums and the root are off by 3.5 u of the distance.
const double closest_below = diagonal * (6 + 3.5) * u64;

TEST(Rounding, ClosestPointsAreNeverTooNear) {
  const auto cases = points_and_triangles(60);
  const auto exact = exact_of(cases, exact_distance);
  const KernelError error = errors_of(cases, exact, program_distance);
  EXPECT_LE(error.below, closest_below) << error.worst;
  // Slivers: what a wrong normal hides is found on an edge (core/spatial/point_triangle.h).
  EXPECT_LE(error.above, 1e-12) << error.worst;
  EXPECT_LE(closest_below, distance_rounding);
}

// The simplifier never underestimates its distances, but for the rounding of a closest point.
TEST(Rounding, DistancesOfTheSimplifierAreBounds) {
  const auto scheduler = make_serial_scheduler();
  for (const HardCase& hard : hard_cases()) {
    if (!hard.refusal.empty()) continue;
    SCOPED_TRACE(std::string(hard.name));
    Repairs repairs;
    const IndexedMesh mesh = prepare_mesh(hard_mesh(hard, 300), repairs, *scheduler);
    const std::vector<std::uint8_t> locked(mesh.positions.size(), 0);
    const auto simplifier = make_simplifier("quadric");
    const SimplifyResult& result =
        simplifier->simplify({mesh.positions, mesh.triangles, locked, 0.3f, mesh.triangles.size() / 4});
    ASSERT_EQ(result.distance.size(), mesh.positions.size());
    std::vector<Vec3d> places;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      places.push_back(to_double(result.positions[result.parent[v]]));
    std::vector<Triangle> images;
    for (const Triangle& t : mesh.triangles)
      images.push_back({{result.parent[t.v[0]], result.parent[t.v[1]], result.parent[t.v[2]]}});
    // Images of one point or one edge are part of the surface that distances are from.
    const ExactSurface surface(places, images);
    for (std::size_t v = 0; v < mesh.positions.size(); v += 3)
      ASSERT_TRUE(surface.is_within(exact(mesh.positions[v]), Rational(double{result.distance[v]} + closest_below)))
          << v;
  }
}

// In double about the origin of the cube, where terms as large as the squared distance of the plane from it cancel; in
// float about the vertex, where they are no larger than the star.
TEST(Rounding, QuadricsKeepSmallDistances) {
  const auto cases = stars(60);
  const auto exact = exact_of(cases, exact_quadric);
  // A root of what cancels: sqrt of some twenty roundings of squared lengths up to 3, of the mean over the planes.
  const double bound = std::sqrt(20 * 3 * u64);
  EXPECT_LE(errors_of(cases, exact, quadric_in_double).largest(), bound);
  // Relative to the star, which is at most the cube.
  EXPECT_LE(errors_of(cases, exact, centred_quadric_in_float).largest(), std::sqrt(20 * 3 * u32));
  // Float about the origin would not do: by how much depends on the stars.
  EXPECT_GT(errors_of(cases, exact, plain_quadric_root<float>).largest(), 100 * bound);
}

TEST(Rounding, PlacesAreThoseOfTheExactMinimum) {
  constexpr double stiffness = 1e-6;
  for (const Star& star : stars(60)) {
    Quadric q;
    for (std::size_t k = 0; k < star.normals.size(); ++k) q.add_plane(star.normals[k], star.points[k], star.weights[k]);
    const ExactPoint found = exact(q.minimum_near(star.x, stiffness));
    const ExactPoint least = exact_minimum(star, star.x, stiffness);
    const double off = static_cast<double>(root_of(squared_distance(found, least)));
    const double step = static_cast<double>(root_of(squared_distance(exact(star.x), least)));
    // Eigenvalues over the weight are from the stiffness to 1. Cofactors are differences of products of two of them:
    // off by some u, and as small as the square of the stiffness where the surface is flat.
    EXPECT_LE(off, 60 * u64 * (step / (stiffness * stiffness) + 1 / stiffness)) << star.name;
    EXPECT_LE(off, 1e-5) << star.name;
  }
}

// The distance is off by 3.5 u of itself; the band's ends are exact; the quotient, the polynomial and the difference
// add eight u.
TEST(Rounding, LambdaIsOffByWhatTheDistanceIs) {
  double largest = 0;
  for (const BandView& view : band_views(20'000)) {
    Radii radii;
    radii.select = {view.end, 0};
    radii.band_begin = {HUGE_VALF, view.begin};
    radii.band_end = {HUGE_VALF, view.end};
    const MorphContext context{nullptr, &radii, Blend::smoothstep, view.from};
    const double off =
        std::abs(static_cast<double>(plain_lambda<long double>(view) - morph_lambda(context, 1, view.vertex)));
    const double allowed =
        1.5 * (3.5 * u32 * view.end + u32 * (view.end - view.begin)) / (view.end - view.begin) + 8 * u32;
    EXPECT_LE(off, allowed);
    largest = std::max(largest, off);
  }
  EXPECT_GT(largest, u32);
  // The bound of the jumps allows this much for two frames.
  EXPECT_GE(view_rounding, 2 * 3.5 * u32);
}

double twice_area_of(const std::array<Vec3d, 3>& t) { return length(cross(t[1] - t[0], t[2] - t[0])); }

// The ratio of terms to their sums: the squared longest edge over twice the area.
double condition_of(const std::array<Vec3d, 3>& t) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, length(t[(k + 1) % 3] - t[k]));
  return longest * longest / twice_area_of(t);
}

TEST(Rounding, StretchLosesWhatThinTrianglesLose) {
  const auto cases = sphere_triangles(40);
  const auto exact = exact_of(cases, plain_stretch<long double>);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const auto& [name, surface, sphere] = cases[k];
    // On the sphere edges and heights are differences of unit vectors, each of which is off by some u.
    const double allowed = 64 * u64 * (condition_of(surface) + 1 / twice_area_of(sphere));
    EXPECT_NEAR(static_cast<double>(program_stretch(cases[k]) / exact[k]), 1, allowed) << name;
  }
}

TEST(Rounding, FlipInFloatIsThatInDouble) {
  const auto scheduler = make_serial_scheduler();
  double largest = 0;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Image a = testing::pattern({64, 48}, seed), b = testing::pattern({64, 48}, seed + 7);
    const ErrorMap fast = flip_error(a, b, *scheduler);
    const std::vector<double> slow = testing::NaiveFlip(FlipConfig{}.pixels_per_degree)(a, b);
    for (std::size_t i = 0; i < slow.size(); ++i) largest = std::max(largest, std::abs(fast.value[i] - slow[i]));
  }
  EXPECT_LE(largest, 2e-4);
}

// Three directions in a plane but for the last bits: the sign is that of the exact determinant.
TEST(Rounding, OrientationsAreExact) {
  std::mt19937_64 random(8);
  const auto part = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
  int zero = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Vec3d a{part(), part(), part()}, b{part(), part(), part()};
    const double s = part(), t = part();
    Vec3d c = s * a + t * b;
    if (k % 3 == 0) c = 2.0 * a;
    const Rational exact_sign = dot(exact(a), cross(exact(b), exact(c)));
    ASSERT_EQ(orientation(a, b, c), sgn(exact_sign));
    zero += sgn(exact_sign) == 0;
  }
  EXPECT_GT(zero, 6000);
}

}  // namespace
}  // namespace lodestone::test
