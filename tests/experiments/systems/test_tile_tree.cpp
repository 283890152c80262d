// Tiles that replace each other: complete, within their errors; they crack, and skirts cover that.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "experiments/systems/surface/surface_distance.h"
#include "experiments/systems/tiles/tile_tree.h"
#include "tests/expect_error.h"
#include "tests/experiments/systems/system_models.h"

namespace lodestone {
namespace {

using namespace testing;

const Hierarchy& large_torus() {
  static const test::NaiveHierarchy made = test::naive_hierarchy(test::torus_mesh(240, 120), 3);
  return made.hierarchy;
}

const WeldedSurface& surface() {
  static const WeldedSurface made = welded_surface(torus(), "test");
  return made;
}

std::vector<TileNode> tiles(Scheduler& scheduler) {
  return build_tile_tree(surface(), {.tile_triangles = 300}, scheduler);
}

TEST(TileTree, LeavesAreTheSurface) {
  const std::vector<TileNode> all = tiles(*make_serial_scheduler());
  std::size_t triangles = 0;
  for (const TileNode& tile : all) {
    EXPECT_FALSE(tile.mesh.triangles.empty());
    for (std::uint32_t c = 0; c < tile.child_count; ++c) {
      EXPECT_GE(tile.error, all[tile.first_child + c].error);
      EXPECT_TRUE(tile.box.contains(all[tile.first_child + c].box));
      EXPECT_EQ(all[tile.first_child + c].gap, 2 * tile.error);
    }
    if (tile.child_count > 0) continue;
    triangles += tile.mesh.triangles.size();
    EXPECT_LE(tile.mesh.triangles.size(), 300u);
    EXPECT_EQ(tile.error, 0);
  }
  EXPECT_EQ(triangles, surface().triangles.size());
}

TEST(TileTree, TilesAreWithinTheToleranceWhereTheyAreSeen) {
  const std::vector<TileNode> all = tiles(*make_serial_scheduler());
  std::size_t most = 0;
  for_views(30, [&](Vec3f viewpoint, double reach) {
    PartMesh drawn;
    for (const std::uint32_t t : tiles_for(all, viewpoint, reach)) {
      const auto first = static_cast<std::uint32_t>(drawn.positions.size());
      drawn.positions.insert(drawn.positions.end(), all[t].mesh.positions.begin(), all[t].mesh.positions.end());
      for (const auto& [v] : all[t].mesh.triangles)
        drawn.triangles.push_back({{first + v[0], first + v[1], first + v[2]}});
    }
    most = std::max(most, drawn.triangles.size());
    const TriangleBvh tree = tree_of({drawn.positions, drawn.triangles});
    for (const Vec3f p : surface().positions)
      EXPECT_LE(std::sqrt(tree.nearest(to_double(p)).squared_distance) * reach,
                length(to_double(viewpoint) - to_double(p)) * (1 + 1e-6) + 1e-9 * reach);
  });
  EXPECT_EQ(most, surface().triangles.size());
}

TEST(TileTree, SkirtsHangFromTheCutsAlone) {
  const std::vector<TileNode> all = tiles(*make_serial_scheduler());
  const std::vector<std::uint8_t> closed = border_vertices(surface());
  EXPECT_EQ(std::ranges::count(closed, 1), 0);
  EXPECT_TRUE(skirt_of(all.front(), surface(), closed).triangles.empty()) << "the root is a whole torus";
  for (const TileNode& tile : all) {
    const Skirt skirt = skirt_of(tile, surface(), closed);
    if (tile.child_count == 0) {
      EXPECT_FALSE(skirt.triangles.empty());
    }
    ASSERT_EQ(skirt.positions.size(), 2 * skirt.triangles.size());
    for (std::size_t v = 0; v < skirt.positions.size(); v += 2)
      EXPECT_NEAR(length(skirt.positions[v] - skirt.positions[v + 1]), tile.gap, 1e-5);
  }
  const WeldedSurface field = welded_surface(terrain(), "test");
  const std::vector<std::uint8_t> ends = border_vertices(field);
  EXPECT_EQ(std::ranges::count(ends, 1), 2 * (150 + 101) - 4);
  const std::vector<TileNode> whole =
      build_tile_tree(field, {.tile_triangles = field.triangles.size()}, *make_serial_scheduler());
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_TRUE(skirt_of(whole.front(), field, ends).triangles.empty()) << "the surface itself ends there";
}

TEST(TileTree, IsTheSameForAnyNumberOfThreads) {
  const std::vector<TileNode> one = tiles(*make_serial_scheduler()), three = tiles(*make_tbb_scheduler(3));
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t t = 0; t < one.size(); ++t) {
    EXPECT_EQ(one[t].mesh.vertices, three[t].mesh.vertices);
    EXPECT_EQ(one[t].mesh.triangles, three[t].mesh.triangles);
    EXPECT_EQ(one[t].error, three[t].error);
  }
  EXPECT_TRUE(build_tile_tree({}, {}, *make_serial_scheduler()).empty());
}

TEST(TilesReplace, CracksAndSkirtsCoverThem) {
  std::uint64_t open = 0, leaks = 0, covered_open = 0, covered_leaks = 0;
  for (const SystemRow& row : fly(large_torus(), {"tiles-replace", "tiles-replace-skirts"}, 0.5f, 8)) {
    const bool skirts = row.system == "tiles-replace-skirts";
    (skirts ? covered_open : open) += row.surface.value().open_edges;
    (skirts ? covered_leaks : leaks) += row.surface->leak_pixels.value();
    EXPECT_LT(row.screen_error.value(), 0.6) << row.system;
    EXPECT_FALSE(row.surface->jump);
  }
  EXPECT_GT(open, 0u);
  EXPECT_EQ(covered_open, open) << "cracks are there all the same";
  EXPECT_GT(leaks, 0u);
  EXPECT_EQ(covered_leaks, 0u) << "of " << leaks;
}

TEST(OwnSurfaces, RefuseAttributes) {
  Hierarchy coloured = torus();
  coloured.attributes.colours = true;
  for (const std::string system :
       {"tiles-replace", "vdpm", "progressive-whole", "clipmap", "chunked-skirts", "known-step"})
    expect_error_of<InputError>([&] { (void)lod_system(system).patches(coloured, *make_serial_scheduler()); },
                                {system, "positions and normals alone"});
}

}  // namespace
}  // namespace lodestone
