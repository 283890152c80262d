// T-junctions: known ones, and all pairs of vertices and edges as the slow twin.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/base/error.h"
#include "core/spatial/point_triangle.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/drawn/drawn_mesh.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_hierarchy.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone {
namespace {

using namespace testing;
using Key = std::array<double, 3>;

Key key(Vec3d p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

struct NaiveJunctions {
  std::size_t junctions = 0, vertices = 0, border_edges = 0;
  double worst = 0;
};

NaiveJunctions naive_junctions(const DrawnMesh& mesh, double tolerance) {
  std::map<std::pair<Key, Key>, int> net;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Key a = key(mesh.positions[t.v[k]]), b = key(mesh.positions[t.v[(k + 1) % 3]]);
      if (a < b) ++net[{a, b}];
      if (b < a) --net[{b, a}];
    }
  std::set<Key> vertices, lying;
  std::erase_if(net, [](const auto& edge) { return edge.second == 0; });
  for (const auto& [ends, sign] : net) vertices.insert({ends.first, ends.second});
  NaiveJunctions result;
  result.border_edges = net.size();
  const auto vec = [](const Key& k) { return Vec3d{k[0], k[1], k[2]}; };
  for (const auto& [ends, sign] : net)
    for (const Key& v : vertices) {
      if (v == ends.first || v == ends.second) continue;
      const Vec3d a = vec(ends.first), b = vec(ends.second);
      const NearestPoint foot = nearest_on_segment(vec(v), a, b);
      if (foot.squared_distance > tolerance * tolerance) continue;
      if (squared_length(foot.point - a) <= tolerance * tolerance) continue;
      if (squared_length(foot.point - b) <= tolerance * tolerance) continue;
      ++result.junctions;
      lying.insert(v);
      result.worst = std::max(result.worst, std::sqrt(foot.squared_distance));
    }
  result.vertices = lying.size();
  return result;
}

TJunctionReport find(const DrawnMesh& mesh, double tolerance) {
  const auto scheduler = make_serial_scheduler();
  return t_junctions(mesh.positions, mesh.triangles, tolerance, *scheduler);
}

void expect_twins_agree(const DrawnMesh& mesh, double tolerance) {
  const TJunctionReport fast = find(mesh, tolerance);
  const NaiveJunctions slow = naive_junctions(mesh, tolerance);
  EXPECT_EQ(fast.junctions, slow.junctions) << tolerance;
  EXPECT_EQ(fast.vertices, slow.vertices);
  EXPECT_EQ(fast.border_edges, slow.border_edges);
  EXPECT_NEAR(fast.worst, slow.worst, 1e-15);
}

// A large triangle below the line y = 0, two small ones above it that meet at (0.5, height).
DrawnMesh junction(double height) {
  return {{{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0}, {0.5, height, 0}, {0.2, 1, 0}, {0.8, 1, 0}},
          {{{0, 2, 1}}, {{0, 3, 4}}, {{3, 1, 5}}}};
}

TEST(TJunctions, FindsTheOneThatIsThere) {
  const TJunctionReport exact = find(junction(0), 0);
  EXPECT_EQ(exact.junctions, 1u);
  EXPECT_EQ(exact.vertices, 1u);
  EXPECT_EQ(exact.worst, 0);
  EXPECT_EQ(exact.where, (Vec3d{0.5, 0, 0}));
  const TJunctionReport off = find(junction(0.01), 0.02);
  EXPECT_EQ(off.junctions, 1u);
  EXPECT_NEAR(off.worst, 0.01, 1e-15);
  EXPECT_EQ(find(junction(0.03), 0.02).junctions, 0u);
}

TEST(TJunctions, NoneWhereTheEdgeIsSplit) {
  DrawnMesh mesh = junction(0);
  mesh.triangles = {{{0, 2, 3}}, {{3, 2, 1}}, {{0, 3, 4}}, {{3, 1, 5}}};
  EXPECT_EQ(find(mesh, 0).junctions, 0u);
  EXPECT_EQ(find(mesh, 1e-3).junctions, 0u);
}

TEST(TJunctions, CopiesOfAVertexAreOne) {
  // A closed box whose cells have copies of their own: no border, whatever the tolerance.
  const NaiveHierarchy built = naive_hierarchy(box_mesh(6), 2, 0.6f);
  const DrawnMesh mesh = finest_mesh(built.hierarchy);
  const TJunctionReport report = find(mesh, 0.01);
  EXPECT_EQ(report.border_edges, 0u);
  EXPECT_EQ(report.junctions, 0u);
}

TEST(TJunctions, EqualTheirSlowTwin) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, 3, 0.6f);
    const DrawnMesh whole = finest_mesh(built.hierarchy);
    for (const double tolerance : {0.0, 1e-4, 0.003, 0.02}) expect_twins_agree(whole, tolerance);
    // Every third triangle moved a little: borders everywhere, vertices on and beside other edges.
    DrawnMesh torn = whole;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> shift(-0.002, 0.002);
    for (std::size_t i = 0; i < torn.triangles.size(); i += 3)
      for (std::uint32_t& v : torn.triangles[i].v) {
        const Vec3d p = torn.positions[v];
        torn.positions.push_back({p.x + shift(random), p.y + shift(random), p.z + shift(random)});
        v = static_cast<std::uint32_t>(torn.positions.size() - 1);
      }
    torn.triangles.resize(std::min<std::size_t>(torn.triangles.size(), 900));
    for (const double tolerance : {1e-5, 1e-3, 0.01}) expect_twins_agree(torn, tolerance);
  }
}

TEST(TJunctions, AppearWhereLevelsMeetWithoutMorph) {
  const NaiveHierarchy built = naive_hierarchy(terrain_mesh(32), 4, 0.6f);
  const auto scheduler = make_serial_scheduler();
  const Radii uniform = uniform_radii(built.hierarchy, DistanceMetric::euclidean,
                                      1.1f * greatest_reach(built.hierarchy, DistanceMetric::euclidean));
  ASSERT_TRUE(uniform.admissible);
  Radii still = uniform;
  still.band_begin.assign(still.band_begin.size(), 1e9f);
  still.band_end.assign(still.band_end.size(), 1e9f);
  std::uint64_t without = 0;
  for (const Vec3f view : random_viewpoints(built.hierarchy, 30, 5)) {
    const double tolerance = 0.1 * cell_size(4);
    const auto found = [&](const Radii& radii) {
      const Frame frame = make_frame(built.hierarchy, radii, Blend::linear, view);
      return t_junctions(frame.context, frame.selection, tolerance, *scheduler);
    };
    const TJunctionReport morphed = found(uniform), bare = found(still);
    EXPECT_LE(morphed.border_edges, 4u * 32) << "the border of the terrain";
    if (bare.border_edges > morphed.border_edges) without += bare.junctions;
  }
  EXPECT_GT(without, 0u);
}

TEST(TJunctions, AreTheSameForAnyNumberOfWorkers) {
  const NaiveHierarchy built = naive_hierarchy(torn_mesh(40), 3, 0.6f);
  const DrawnMesh mesh = finest_mesh(built.hierarchy);
  const TJunctionReport serial = find(mesh, 0.02);
  ASSERT_GT(serial.junctions, 0u);
  for (const int threads : {2, 5}) {
    const TJunctionReport report = t_junctions(mesh.positions, mesh.triangles, 0.02, *make_tbb_scheduler(threads));
    EXPECT_EQ(report.junctions, serial.junctions);
    EXPECT_EQ(report.vertices, serial.vertices);
    EXPECT_EQ(report.worst, serial.worst);
    EXPECT_EQ(report.where, serial.where);
  }
}

TEST(TJunctions, NothingAndWhatIsRefused) {
  EXPECT_EQ(find({}, 0.1).border_edges, 0u);
  EXPECT_EQ(find({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{{0, 1, 1}}}}, 0.1).border_edges, 0u);
  // A triangle without area lies on itself.
  EXPECT_EQ(find({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{{0, 1, 2}}}}, 0.1).junctions, 1u);
  for (const double tolerance : {-1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW((void)find(junction(0), tolerance), InputError);
  DrawnMesh bad = junction(0);
  bad.positions[4].x = std::nan("");
  EXPECT_THROW((void)find(bad, 0.1), InputError);
}

}  // namespace
}  // namespace lodestone
