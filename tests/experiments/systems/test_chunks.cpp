// Chunked height fields: right triangles are within their tolerance, chunks cover the field and move into each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/systems/terrain/chunk_tree.h"
#include "tests/expect_error.h"
#include "tests/experiments/systems/system_models.h"

namespace lodestone {
namespace {

using namespace testing;

const HeightField& field() {
  static const HeightField made(welded_surface(terrain(), "test"), "test");
  return made;
}

// The height of corners over a post that is in the triangle; not a number where it is not.
double height_in(const RightTriangles::Corners& t, Post p) {
  const auto turn = [](Post a, Post b, Post c) { return (b.i - a.i) * (c.j - a.j) - (b.j - a.j) * (c.i - a.i); };
  const double whole = turn(t[0], t[1], t[2]);
  double height = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double share = turn(t[(k + 1) % 3], t[(k + 2) % 3], p) / whole;
    if (share < 0) return std::nan("");
    height += share * double{field().height(t[k])};
  }
  return height;
}

TEST(HeightField, IsFoundInAModel) {
  EXPECT_EQ(field().columns(), 150);
  EXPECT_EQ(field().rows(), 101);
  const WeldedSurface surface = welded_surface(terrain(), "test");
  const std::vector<Vec3f> places = field().places();
  for (const Vec3f p : surface.positions) EXPECT_NE(std::ranges::find(places, p), places.end());
  for (const Post p : {Post{0, 0}, {149, 100}, {17, 3}}) {
    const HeightField::Over over = field().over(field().place(p, 0.5f));
    EXPECT_NEAR(over.column, p.i, 1e-3);
    EXPECT_NEAR(over.row, p.j, 1e-3);
    EXPECT_EQ(over.height, 0.5);
    EXPECT_NEAR(field().height_at(p.i, p.j), field().height(p), 1e-7);
  }
}

TEST(HeightField, RefusesOtherModels) {
  WeldedSurface holed = welded_surface(terrain(), "test");
  holed.triangles.pop_back();
  for (const auto& surface : {holed, welded_surface(torus(), "test")})
    expect_error_of<InputError>([&] { (void)HeightField(surface, "clipmap"); },
                                {"clipmap", "height fields alone", "without voids"});
  for (const std::string system : {"clipmap", "chunked-skirts"})
    expect_error_of<InputError>([&] { (void)lod_system(system).patches(torus(), *make_serial_scheduler()); },
                                {system, "height fields alone"});
}

TEST(RightTriangles, AreWithinTheirTolerance) {
  const RightTriangles triangles(field());
  EXPECT_EQ(triangles.side(), 256);
  for (const float tolerance : {0.0f, 0.001f, 0.01f, 0.05f}) {
    const Square whole{0, 0, triangles.side()};
    const std::vector<RightTriangles::Corners> cut = triangles.cut(whole, tolerance);
    std::size_t seen = 0;
    for (int j = 0; j < field().rows(); j += 3)
      for (int i = 0; i < field().columns(); i += 3) {
        const Post p{i, j};
        const float drawn = triangles.height(whole, tolerance, p);
        EXPECT_LE(std::abs(drawn - field().height(p)), tolerance * (1 + 1e-5) + 1e-7);
        const auto under = std::ranges::find_if(cut, [&](const auto& t) { return !std::isnan(height_in(t, p)); });
        ASSERT_NE(under, cut.end());
        EXPECT_NEAR(height_in(*under, p), drawn, 1e-6) << "by any triangle that has it, as these are continuous";
        ++seen;
      }
    EXPECT_GT(seen, 1000u);
  }
}

TEST(RightTriangles, OfSquaresFitEachOther) {
  const RightTriangles triangles(field());
  DrawnMesh mesh;
  for (int j = 0; j < 256; j += 32)
    for (int i = 0; i < 256; i += 32)
      for (const auto& corners : triangles.cut({i, j, 32}, 0.01f)) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Post p : corners) mesh.positions.push_back(to_double(field().place(p, field().height(p))));
        mesh.triangles.push_back({{first, first + 1, first + 2}});
      }
  for (const BorderEdge& edge : border_edges(mesh.positions, mesh.triangles))
    for (const std::uint32_t v : edge.vertex) {
      const HeightField::Over over = field().over(to_float(mesh.positions[v]));
      EXPECT_TRUE(over.column < 0.01 || over.row < 0.01 || over.column > 148.99 || over.row > 99.99);
    }
}

TEST(ChunkTree, ChunksCoverTheFieldOnce) {
  const ChunkTree tree(field());
  ASSERT_EQ(tree.finest(), 3);
  for (int level = 1; level <= tree.finest(); ++level) EXPECT_LE(tree.tolerance(level), tree.tolerance(level - 1));
  EXPECT_EQ(tree.tolerance(tree.finest()), 0);
  std::set<int> levels;
  for_views(60, [&](Vec3f viewpoint, double reach) {
    std::vector<int> covered(static_cast<std::size_t>(field().columns() * field().rows()), 0);
    for (const DrawnChunk& drawn : tree.chunks_for(viewpoint, reach)) {
      const Chunk& chunk = tree.chunks()[drawn.chunk];
      levels.insert(chunk.level);
      EXPECT_TRUE(drawn.share >= 0 && drawn.share <= 1);
      for (std::size_t p = 0; p < chunk.posts.size(); ++p) {
        EXPECT_EQ(tree.drawn_height(drawn, p), tree.height_over(drawn, chunk.posts[p]));
        const double most = std::max(tree.tolerance(chunk.level), tree.tolerance(std::max(chunk.level - 1, 0)));
        EXPECT_LE(std::abs(tree.drawn_height(drawn, p) - field().height(chunk.posts[p])), most * 1.00001 + 1e-7);
      }
      for (int j = chunk.square.j; j < std::min(chunk.square.j + chunk.square.side, field().rows()); ++j)
        for (int i = chunk.square.i; i < std::min(chunk.square.i + chunk.square.side, field().columns()); ++i)
          ++covered[field().index({i, j})];
    }
    for (int j = 0; j + 1 < field().rows(); ++j)
      for (int i = 0; i + 1 < field().columns(); ++i) EXPECT_EQ(covered[field().index({i, j})], 1);
  });
  EXPECT_EQ(levels.size(), 4u);
}

TEST(ChunkTree, PostsMoveToWhereTheParentHasThem) {
  const ChunkTree tree(field());
  for (std::uint32_t c = 1; c < tree.chunks().size(); ++c) {
    const Chunk& chunk = tree.chunks()[c];
    for (std::size_t p = 0; p < chunk.posts.size(); ++p) {
      EXPECT_EQ(tree.drawn_height({c, 0}, p), field().height(chunk.posts[p]));
      EXPECT_EQ(tree.drawn_height({c, 1}, p), tree.height_over({chunk.parent, 0}, chunk.posts[p]));
    }
  }
}

TEST(ChunkedSkirts, DrawsWithinTheTolerance) {
  double largest = 0;
  std::uint64_t open = 0;
  for (const SystemRow& row : fly(terrain(), {"chunked-skirts"}, 1, 20)) {
    EXPECT_LT(row.screen_error.value(), 1.3);  // posts alone are measured
    open += row.surface.value().open_edges;
    if (row.surface->jump) largest = std::max(largest, row.surface->jump->pixels);
  }
  EXPECT_GT(open, 0u);
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 0.5) << "it moves, and does not pop";
}

}  // namespace
}  // namespace lodestone
