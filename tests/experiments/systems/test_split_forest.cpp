// View-dependent refinement: every front is closed, legal and within its tolerance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/progressive/mesh/level.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/systems/progressive/split_forest.h"
#include "experiments/systems/surface/surface_distance.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/experiments/systems/system_models.h"

namespace lodestone {
namespace {

using namespace testing;

const WeldedSurface& surface() {
  static const WeldedSurface made = welded_surface(torus(), "test");
  return made;
}

const SplitForest& forest() {
  static const SplitForest made(surface(), torus().transform, *make_serial_scheduler());
  return made;
}

TEST(SplitForest, EveryFrontIsClosed) {
  std::size_t least = surface().triangles.size(), most = 0;
  for_views(60, [&](Vec3f viewpoint, double reach) {
    const DrawnMesh cut = to_drawn(forest().points(), forest().triangles(forest().refine(to_double(viewpoint), reach)));
    EXPECT_TRUE(border_edges(cut.positions, cut.triangles).empty());
    least = std::min(least, cut.triangles.size()), most = std::max(most, cut.triangles.size());
  });
  EXPECT_LT(least, surface().triangles.size() / 20);
  EXPECT_GT(most, surface().triangles.size() / 2);
}

TEST(SplitForest, HasWhatSplitsDependOn) {
  const auto count = static_cast<std::uint32_t>(forest().points().size());
  for (std::uint32_t v = forest().base_vertices(); v < count; ++v) {
    EXPECT_FALSE(forest().needs(VertexId(v)).empty());
    for (const std::uint32_t need : forest().needs(VertexId(v))) EXPECT_LT(need, v);
  }
  for_views(20, [&](Vec3f viewpoint, double reach) {
    const std::vector<std::uint32_t> drawn_for = forest().refine(to_double(viewpoint), reach);
    for (std::uint32_t v = 0; v < count; ++v) {
      EXPECT_EQ(drawn_for[drawn_for[v]], drawn_for[v]);
      if (drawn_for[v] != v) continue;
      for (const std::uint32_t need : forest().needs(VertexId(v))) EXPECT_EQ(drawn_for[need], need);
    }
  });
}

// Against all prefixes, one by one: nothing is drawn that is in none of them.
TEST(SplitForest, DrawsTrianglesOfPrefixesAlone) {
  ProgressiveReport report;
  const auto scheduler = make_serial_scheduler();
  const ProgressiveMesh mesh = make_progressive(indexed_mesh(surface(), torus().transform), {}, *scheduler, report);
  const LevelFinder levels(mesh);
  const auto turned = [](const Triangle& t) {
    const auto first = static_cast<std::size_t>(std::ranges::min_element(t.v) - t.v.begin());
    return std::array{t.v[first], t.v[(first + 1) % 3], t.v[(first + 2) % 3]};
  };
  std::set<std::array<std::uint32_t, 3>> known;
  for (std::uint32_t vertices = mesh.base_vertices; vertices <= mesh.vertex_count(); ++vertices)
    for (const Triangle& t : levels.compute_level(vertices)) known.insert(turned(t));
  for_views(20, [&](Vec3f viewpoint, double reach) {
    for (const Triangle& t : forest().triangles(forest().refine(to_double(viewpoint), reach)))
      EXPECT_TRUE(known.contains(turned(t)));
  });
}

// By brute force, for the vertices of the surface and the middles of the triangles that are drawn.
TEST(SplitForest, ErrorsAreWithinTheToleranceWhereTheyAreSeen) {
  const TriangleBvh full = tree_of({surface().positions, surface().triangles});
  for_views(20, [&](Vec3f viewpoint, double reach) {
    const std::vector<Triangle> triangles = forest().triangles(forest().refine(to_double(viewpoint), reach));
    const TriangleBvh drawn = tree_of({forest().points(), triangles});
    const auto expect_near = [&](Vec3d p, const TriangleBvh& other) {
      const double off = std::sqrt(other.nearest(p).squared_distance);
      EXPECT_LE(off * reach, length(to_double(viewpoint) - p) * (1 + 1e-6) + 1e-9 * reach);
    };
    for (const Vec3f p : surface().positions) expect_near(to_double(p), drawn);
    for (const auto& [v] : triangles)
      expect_near((1.0 / 3) * (to_double(forest().points()[v[0]]) + to_double(forest().points()[v[1]]) +
                               to_double(forest().points()[v[2]])),
                  full);
  });
}

TEST(SplitForest, EndsAtTheSurfaceAndAtTheBase) {
  const auto whole = forest().triangles(forest().refine({0.5, 0.5, 0.5}, 1e12));
  EXPECT_EQ(whole.size(), surface().triangles.size());
  for (const std::uint32_t v : forest().refine({0.5, 0.5, 100}, 1e-3)) EXPECT_LT(v, forest().base_vertices());
}

TEST(SplitForest, IsTheSameForAnyNumberOfThreads) {
  const SplitForest other(surface(), torus().transform, *make_tbb_scheduler(3));
  for_views(5, [&](Vec3f viewpoint, double reach) {
    EXPECT_EQ(other.refine(to_double(viewpoint), reach), forest().refine(to_double(viewpoint), reach));
  });
}

TEST(Vdpm, PopsWithoutCracks) {
  double largest = 0;
  for (const SystemRow& row : fly(torus(), {"vdpm"}, 1, 30)) {
    EXPECT_EQ(row.surface.value().open_edges, 0u);
    EXPECT_EQ(row.surface->torn_pixels.value(), 0u);
    EXPECT_LT(row.screen_error.value(), 1.05);
    if (row.surface->jump) largest = std::max(largest, row.surface->jump->pixels);
  }
  EXPECT_GT(largest, 0.5);
}

}  // namespace
}  // namespace lodestone
