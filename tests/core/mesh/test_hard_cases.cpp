// The catalogue of hard surfaces: files of it are read, and have what they are named after.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/edge_census.h"
#include "tests/expect_error.h"
#include "tests/hard_mesh.h"

namespace lodestone {
namespace {

constexpr std::uint64_t most = 2'000;  // triangles of a case

struct Cleaned {
  IndexedMesh mesh;
  Repairs repairs;
  EdgeCensus edges;
};
Cleaned cleaned(std::string_view name) {
  Cleaned result;
  result.mesh = clean_mesh(test::hard_mesh(hard_case(name), most), result.repairs);
  result.edges = count_edges(result.mesh.triangles, result.mesh.positions.size());
  return result;
}

TEST(HardCases, AreReadAndAreAsLargeAsTheySay) {
  std::set<std::string_view> names;
  for (const HardCase& hard : hard_cases()) {
    EXPECT_TRUE(names.insert(hard.name).second) << hard.name;
    const RawMesh mesh = test::hard_mesh(hard, most);
    const auto size = static_cast<double>(std::min(hard.size, most));
    EXPECT_LE(static_cast<double>(mesh.triangles.size()), 2 * size) << hard.name;
    EXPECT_GE(static_cast<double>(mesh.triangles.size()), 0.4 * size) << hard.name;
    Repairs repairs;
    if (!hard.refusal.empty() || hard.name == "nothing") continue;
    EXPECT_GT(clean_mesh(test::hard_mesh(hard, most), repairs).triangles.size(), 0u) << hard.name;
  }
  expect_error_of<InputError>([] { return hard_case("needle"); }, {"'needle'", "known are", "needles"});
}

TEST(HardCases, HaveWhatTheyAreNamedAfter) {
  EXPECT_GT(cleaned("not-finite").repairs.non_finite_triangles, 10u);
  EXPECT_GT(cleaned("zero-area").repairs.degenerate_triangles, 100u);
  EXPECT_GT(cleaned("duplicate-faces").repairs.duplicate_triangles, 1000u);
  EXPECT_GT(cleaned("unused-vertices").repairs.unreferenced_vertices, 500u);
  EXPECT_GT(cleaned("soup").repairs.welded_vertices, 3000u);
  EXPECT_GT(cleaned("misoriented").edges.inconsistent, 500u);
  EXPECT_GT(cleaned("fins").edges.non_manifold, 100u);
  for (const char* closed : {"inside-out", "klein", "crossing", "tiny", "huge", "denormal", "far-away", "negative"})
    EXPECT_EQ(cleaned(closed).edges.border, 0u) << closed;
  for (const char* open : {"holes", "moebius", "plane", "cylinder", "crease", "cone", "confetti"})
    EXPECT_GT(cleaned(open).edges.border, 10u) << open;
  EXPECT_GT(cleaned("moebius").edges.inconsistent, 0u) << "it has one side";
  std::map<std::uint32_t, std::size_t> valence;
  std::size_t highest = 0;
  for (const Triangle& t : cleaned("wheel").mesh.triangles)
    for (const std::uint32_t v : t.v) highest = std::max(highest, ++valence[v]);
  EXPECT_EQ(highest, 2'000u);
}

TEST(HardCases, PolygonsThatAreNotConvexAreCutWithinThemselves) {
  for (const char* name : {"comb", "spiral"}) {
    const PolygonMesh polygon = hard_case(name).make(most);
    EXPECT_EQ(polygon.corners.size(), most) << name;
    EXPECT_EQ(polygon.corners.size(), polygon.positions.size()) << name;
    double area = 0;  // twice that of the polygon
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
      const Vec3d a = polygon.positions[polygon.corners[k]],
                  b = polygon.positions[polygon.corners[(k + 1) % polygon.corners.size()]];
      area += a.x * b.y - a.y * b.x;
    }
    const RawMesh mesh = test::hard_mesh(hard_case(name), most);
    double cut = 0;
    for (const auto& [v] : mesh.triangles) {
      const Vec3d a = mesh.positions[v[0]];
      cut += length(cross(mesh.positions[v[1]] - a, mesh.positions[v[2]] - a));
    }
    EXPECT_EQ(mesh.triangles.size(), polygon.corners.size() - 2) << name;
    EXPECT_NEAR(cut, std::abs(area), 1e-9 * cut) << name;
  }
}

TEST(HardCases, FlatHasReliefInItsMiddleAlone) {
  const RawMesh mesh = test::hard_mesh(hard_case("flat"), most);
  std::size_t flat = 0;
  for (const auto& [v] : mesh.triangles)
    flat += std::ranges::all_of(v, [&](auto k) { return mesh.positions[k].z == 0; });
  EXPECT_GT(flat, 9 * mesh.triangles.size() / 10);
  EXPECT_LT(flat, mesh.triangles.size());
}

}  // namespace
}  // namespace lodestone
