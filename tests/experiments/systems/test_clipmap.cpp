// Geometry clipmaps: nested grids that close up to the ends of the field, wherever the viewer is.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "experiments/metrics/drawn/border.h"
#include "experiments/systems/terrain/clipmap.h"
#include "tests/experiments/systems/system_models.h"

namespace lodestone {
namespace {

using namespace testing;

const HeightField& field() {
  static const HeightField made(welded_surface(terrain(), "test"), "test");
  return made;
}

// Viewers over the field and around it, low and high.
template <class Visit>
void for_grids(int count, const Visit& visit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> column(-40, 190), row(-40, 140), height(0.1, 1.5);
  for (int i = 0; i < count; ++i)
    for (const int posts : {15, 33, 255})
      visit(Clipmap(field(), {column(random), row(random), height(random) * height(random)}, {posts}));
}

bool at_an_end(Vec3d place) {
  const HeightField::Over over = field().over(to_float(place));
  return over.column < 0.01 || over.row < 0.01 || over.column > field().columns() - 1.01 ||
         over.row > field().rows() - 1.01;
}

TEST(Clipmap, ClosesUpToTheEndsOfTheField) {
  std::size_t levels = 0;
  for_grids(40, [&](const Clipmap& clipmap) {
    const Clipmap::Mesh mesh = clipmap.mesh();
    const DrawnMesh drawn = to_drawn(mesh.positions, mesh.triangles);
    for (const BorderEdge& edge : border_edges(drawn.positions, drawn.triangles))
      for (const std::uint32_t v : edge.vertex) EXPECT_TRUE(at_an_end(drawn.positions[v]));
    levels = std::max(levels, clipmap.levels());
  });
  EXPECT_GT(levels, 3u);
}

TEST(Clipmap, CoversTheFieldOnce) {
  const double whole = (field().place({149, 0}, 0).x - field().place({0, 0}, 0).x) *
                       (field().place({0, 100}, 0).y - field().place({0, 0}, 0).y);
  for_grids(20, [&](const Clipmap& clipmap) {
    const Clipmap::Mesh mesh = clipmap.mesh();
    double area = 0;
    for (const auto& [v] : mesh.triangles) {
      const Vec3d a = to_double(mesh.positions[v[0]]), b = to_double(mesh.positions[v[1]]),
                  c = to_double(mesh.positions[v[2]]);
      const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      EXPECT_GE(twice, -1e-9) << "upwards";
      area += 0.5 * twice;
    }
    EXPECT_NEAR(area, whole, 1e-5);
  });
}

TEST(Clipmap, HeightsOverPostsAreThoseThatAreDrawn) {
  for_grids(20, [&](const Clipmap& clipmap) {
    for (const Vec3f p : clipmap.mesh().positions) {
      const HeightField::Over over = field().over(p);
      const Post post{static_cast<int>(over.column + 0.5), static_cast<int>(over.row + 0.5)};
      EXPECT_EQ(clipmap.height_over(post), p.z);
    }
  });
}

TEST(Clipmap, OneGridIsTheFieldItself) {
  const Clipmap clipmap(field(), {75, 50, 0.2}, clipmap_for(field(), 1e6));
  EXPECT_EQ(clipmap.levels(), 1u);
  EXPECT_EQ(clipmap.mesh().triangles.size(), 2u * 149 * 100);
  for (const Post p : {Post{0, 0}, {149, 100}, {31, 77}}) EXPECT_EQ(clipmap.height_over(p), field().height(p));
  EXPECT_EQ(clipmap_for(field(), 60).posts, 81);
  EXPECT_EQ(clipmap_for(field(), 1).posts, 15);
}

TEST(ClipmapSystem, DrawsWithoutCracks) {
  double largest = 0;
  for (const SystemRow& row : fly(terrain(), {"clipmap"}, 4, 20)) {
    EXPECT_EQ(row.surface.value().open_edges, 0u);
    EXPECT_EQ(row.surface->t_junctions.value(), 0u);
    if (row.surface->jump) largest = std::max(largest, row.surface->jump->pixels);
  }
  EXPECT_GT(largest, 0);
}

}  // namespace
}  // namespace lodestone
