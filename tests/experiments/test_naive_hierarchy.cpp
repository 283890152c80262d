// The naive builder against the independent verifier, and against the real builder where the definitions leave no
// choice: the finest level.
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <tuple>

#include "core/hierarchy/verify/verify.h"
#include "parallel/hierarchy/build.h"
#include "tests/experiments/naive_hierarchy.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

using Point = std::tuple<float, float, float>;
using Corners = std::array<Point, 3>;

// A cell's triangles by position, each from its smallest corner on.
std::multiset<Corners> triangles_of(const Cell& cell) {
  std::multiset<Corners> triangles;
  for (const Triangle& t : cell.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = cell.positions[t.v[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.insert(corners);
  }
  return triangles;
}

std::set<Point> points_of(std::span<const Vec3f> positions) {
  std::set<Point> points;
  for (const Vec3f p : positions) points.insert({p.x, p.y, p.z});
  return points;
}

TEST(NaiveHierarchy, ObeysTheDefinitions) {
  for (const NamedMesh& named : all_meshes())
    for (const int finest : {0, 1, 4}) {
      SCOPED_TRACE(named.name);
      const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, 0.6f);
      for (const VerifyCheck& check : verify_hierarchy(built.hierarchy, &named.mesh).checks)
        EXPECT_TRUE(check.passed) << check.name << ": " << check.detail;
    }
}

TEST(NaiveHierarchy, HasTheFinestLevelOfTheRealOne) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    constexpr int finest = 3;
    const NaiveHierarchy naive = naive_hierarchy(named.mesh, finest, 0.6f);
    BuildConfig config;
    config.sigma0 = 0.6f;
    config.finest_level = finest;
    config.simplifier = "cluster";
    const Hierarchy built = build_hierarchy(IndexedMesh(named.mesh), config, *make_serial_scheduler());
    const auto expected = naive.hierarchy.cells_of(finest), found = built.cells_of(finest);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].code, expected[i].code);
      EXPECT_EQ(found[i].bounds, expected[i].bounds);
      EXPECT_EQ(found[i].positions.size(), expected[i].positions.size());
      EXPECT_EQ(triangles_of(found[i]), triangles_of(expected[i]));
      EXPECT_EQ(points_of(found[i].positions), points_of(expected[i].positions));
      EXPECT_EQ(points_of(found[i].positions.subspan(found[i].first_shared())),
                points_of(expected[i].positions.subspan(expected[i].first_shared())));
    }
    for (std::size_t m = 0; m < distance_metric_count; ++m) {
      const float reach = naive.hierarchy.levels.back().reach[m];
      EXPECT_NEAR(built.levels.back().reach[m], reach, 2e-6f * reach);  // both are rounded up
    }
    EXPECT_EQ(built.provenance.fingerprint, naive.hierarchy.provenance.fingerprint);
  }
}

}  // namespace
}  // namespace lodestone
