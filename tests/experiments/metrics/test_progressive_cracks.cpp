// The crack count of progressive meshes: nothing where nothing cracks, and every kind of tear is seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

#include "experiments/metrics/cracks/progressive_cracks.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/core/progressive/progressive_checks.h"
#include "tests/parallel/progressive/progressive_meshes.h"

namespace lodestone {
namespace {

// Three walls that meet at one edge, each of n x n squares: two of them are paired, the third ends there.
IndexedMesh three_walls(std::uint32_t n, Scheduler& scheduler) {
  RawMesh raw;
  for (int wall = 0; wall < 3; ++wall)
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j) {
        const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
          const double out = (i + di) * (wall == 1 ? -1.0 : 1.0), bulge = 0.1 * out * out / n;
          const double up = j + dj;
          raw.positions.push_back(wall == 2 ? Vec3d{bulge, up, out} : Vec3d{out, up, -bulge});
          return static_cast<std::uint32_t>(raw.positions.size() - 1);
        };
        const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        const bool turned = wall == 1;
        raw.triangles.push_back(turned ? Triangle{a, c, b} : Triangle{a, b, c});
        raw.triangles.push_back(turned ? Triangle{a, d, c} : Triangle{a, c, d});
      }
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, scheduler);
}

TEST(ProgressiveCracks, SoundMeshesHaveNone) {
  const auto scheduler = make_serial_scheduler();
  std::vector<IndexedMesh> meshes;
  meshes.push_back(test::sphere_mesh(4));
  meshes.push_back(test::terrain_mesh(30));
  meshes.push_back(test::textured_torus(40, 30, true, *scheduler));
  meshes.push_back(test::touching_cubes(6, *scheduler));
  meshes.push_back(three_walls(12, *scheduler));
  for (const IndexedMesh& mesh : meshes) EXPECT_EQ(residual_edges_of_levels(test::progressive_of(mesh), 20), 0u);
}

TEST(ProgressiveCracks, ThreeWallsAreCutWhereTheyMeet) {
  const auto scheduler = make_serial_scheduler();
  const IndexedMesh mesh = three_walls(12, *scheduler);
  ProgressiveReport report;
  (void)make_progressive(mesh, {}, *scheduler, report);
  EXPECT_EQ(report.cut_edges, 12u);
  EXPECT_EQ(report.cut_vertices, 13u);
}

// Edges between places that a level of a closed surface leaves without a partner.
std::size_t unpaired(const ProgressiveMesh& mesh, std::uint32_t level) {
  std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> balance;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto place = [&](std::size_t corner) {
        const Vec3f p = mesh.positions[test::obvious_ancestor(mesh, t.v[corner % 3], level)];
        return std::array{p.x, p.y, p.z};
      };
      ++balance[{place(k), place(k + 1)}];
      --balance[{place(k + 1), place(k)}];
    }
  return static_cast<std::size_t>(std::count_if(balance.begin(), balance.end(), [](auto& e) { return e.second > 0; }));
}

// The wedges of one vertex, torn apart: the second has another vertex for its parent. In the level before the two came
// in, the triangles of one end elsewhere than those of the other.
TEST(ProgressiveCracks, ATornSeamIsSeen) {
  const auto scheduler = make_serial_scheduler();
  const ProgressiveMesh sound = test::progressive_of(test::textured_torus(40, 30, true, *scheduler));
  const std::vector<std::uint32_t> group = test::obvious_groups(sound);
  int torn = 0;
  for (std::uint32_t v = sound.base_vertices + 1; v < sound.vertex_count(); v += 7) {
    while (v < sound.vertex_count() && group[v] == v) ++v;
    if (v >= sound.vertex_count()) break;
    const std::uint32_t before = group[v];
    ProgressiveMesh mesh = sound;
    std::uint32_t other = 0;
    while (sound.positions[other] == sound.positions[sound.parents[before]]) ++other;
    mesh.parents[v] = other;
    EXPECT_EQ(residual_edges(mesh, mesh.vertex_count()), 0u);
    EXPECT_EQ(residual_edges(mesh, before), unpaired(mesh, before)) << v;
    if (unpaired(mesh, before) > 0) ++torn;  // not where the seam has come to nothing on both sides of the vertex
  }
  EXPECT_GT(torn, 20);
}

// A level that takes one wedge of a vertex without the other.
TEST(ProgressiveCracks, ALevelThatSplitsAVertexIsSeen) {
  const auto scheduler = make_serial_scheduler();
  const ProgressiveMesh mesh = test::progressive_of(test::textured_torus(40, 30, true, *scheduler));
  const std::vector<std::uint32_t> group = test::obvious_groups(mesh);
  int split = 0;
  for (std::uint32_t v = mesh.base_vertices + 1; v < mesh.vertex_count(); ++v) {
    if (group[v] == v) continue;
    EXPECT_GT(residual_edges(mesh, v), 0u) << v;
    if (++split == 20) break;
  }
  EXPECT_EQ(split, 20);
}

// Copies that a cut made may part; vertices that share an edge of two triangles may not.
TEST(ProgressiveCracks, ATearThroughTheSurfaceIsSeen) {
  const ProgressiveMesh sound = test::progressive_of(test::sphere_mesh(4));
  // The last vertex twice, one for each half of its triangles; the copy collapses elsewhere.
  ProgressiveMesh mesh = sound;
  const std::uint32_t last = mesh.vertex_count() - 1;
  mesh.positions.push_back(mesh.positions[last]);
  mesh.errors.push_back(mesh.errors[last]);
  std::uint32_t other = 0, moved = 0;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t.v)
      if ((t.v[0] == last || t.v[1] == last || t.v[2] == last) && v != last && v != mesh.parents[last]) other = v;
  mesh.parents.push_back(other);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v)
      if (v == last && moved++ % 2 == 0) v = last + 1;
  ASSERT_GT(moved, 3u);
  EXPECT_EQ(residual_edges(mesh, last + 2), 0u);
  EXPECT_GT(residual_edges(mesh, last), 0u);
}

}  // namespace
}  // namespace lodestone
