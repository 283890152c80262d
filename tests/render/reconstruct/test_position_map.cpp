// Position maps: the tiled rasterizer against the obvious one, any number of threads, OpenGL, what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.h"
#include "render/backends/make_renderer.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/views/condense_map.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

std::vector<MapView> some_views(const IndexedMesh& mesh) {
  const Box3f box = box_of(mesh);
  std::vector<MapView> views{orthographic_view(box, {0, 0, -1}, 1.0 / 40), orthographic_view(box, {1, 0, 0}, 1.0 / 90),
                             orthographic_view(box, {-0.3, 0.8, -0.5}, 1.0 / 70),
                             perspective_view(box, {1.5, -1.2, 1.9}, 1.0 / 60)};
  for (std::size_t k = 2; k < 4; ++k) {  // and cut off before the middle
    views.push_back(views[k]);
    views.back().nearest = 0.99 * views[k].depth({0.5, 0.5, 0.5});
  }
  return views;
}

IndexedMesh coloured(IndexedMesh mesh) {
  for (const Vec3f& p : mesh.positions) {
    mesh.wedges.uv.push_back({p.x, 1 - p.y});
    mesh.wedges.colour.push_back({static_cast<std::uint8_t>(255 * p.z), 7, static_cast<std::uint8_t>(100 * p.x), 255});
  }
  return mesh;
}

TEST(PositionMap, IsWhatEveryTriangleAgainstEveryPixelGives) {
  const auto serial = make_serial_scheduler();
  for (const IndexedMesh& mesh : {sphere_mesh(3), terrain_mesh(12, 0.3), torus_mesh(9, 5)})
    for (const MapView& view : some_views(mesh))
      EXPECT_EQ(rasterize_map(mesh, view, {}, *serial), obvious_map(mesh, view));
}

// Needles among them: rows take as long as for any triangle, however few of their points are covered. Every third one
// has its edges through points, and as many lie about the first point alone, by a unit or two.
TEST(TriangleCoverage, RowsAndRectanglesAgreeWithPoints) {
  std::mt19937 random(3);
  constexpr std::int64_t step = 256, first = 128, count = 32;
  std::size_t covered = 0, missed = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto place = [&] {
      const auto at = static_cast<std::int32_t>(random() % 9000) - 500;
      return k % 3 == 0 ? at / 256 * 256 + 128 : k % 3 == 1 ? 120 + at % 17 : at;
    };
    const SnappedVertex a{place(), place(), 1}, b{place(), place(), 2};
    const SnappedVertex c =
        k % 2 == 0 ? SnappedVertex{place(), place(), 3} : SnappedVertex{b.x + k % 7, b.y + k % 5, 3};
    const TriangleCoverage coverage(a, b, c);
    if (coverage.area == 0) continue;
    bool any = false;
    for (std::int64_t y = first; y < first + step * count; y += step) {
      const auto [low, high] = coverage.row(y, first, step, count);
      for (std::int64_t i = 0; i < count; ++i) {
        double z = 0;
        const bool at = coverage.at(first + step * i, y, z);
        ASSERT_EQ(low <= i && i <= high, at) << k << ' ' << i << ' ' << y;
        covered += at ? 1 : 0;
        any |= at;
      }
    }
    const bool misses = coverage.misses(first, first, first + step * (count - 1), first + step * (count - 1));
    EXPECT_FALSE(misses && any) << k;
    missed += misses ? 1 : 0;
  }
  EXPECT_GT(covered, 10'000u);
  EXPECT_GT(missed, 10u);
}

TEST(PositionMap, IsTheSameForAnyNumberOfThreads) {
  const IndexedMesh mesh = coloured(sphere_mesh(5));
  const auto serial = make_serial_scheduler(), three = make_tbb_scheduler(3);
  for (const MapView& view : some_views(mesh))
    EXPECT_EQ(rasterize_map(mesh, view, {.uv = true, .colour = true}, *serial),
              rasterize_map(mesh, view, {.uv = true, .colour = true}, *three));
}

TEST(PositionMap, HoldsPointsOfTheSurfaceOnTheRaysOfItsPixels) {
  const IndexedMesh mesh = coloured(terrain_mesh(30, 0.2));
  const auto serial = make_serial_scheduler();
  for (const MapView& view : some_views(mesh)) {
    const PositionMap map = rasterize_map(mesh, view, {.uv = true, .colour = true}, *serial);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < view.pixels(); ++i) {
      if (!map.sees(i)) continue;
      ++seen;
      const WindowPoint w = to_window(view, to_double(map.position[i]));
      // Vertices are snapped for coverage, so that a centre may lie outside by as much; a steep triangle, by its width.
      EXPECT_NEAR(w.x, static_cast<double>(i % static_cast<std::size_t>(view.width)) + 0.5, 0.02);
      EXPECT_NEAR(w.y, static_cast<double>(i / static_cast<std::size_t>(view.width)) + 0.5, 0.02);
      EXPECT_NEAR(w.depth, map.depth[i], 1e-6);
      EXPECT_NEAR(length(map.normal[i]), 1, 1e-5);
      EXPECT_NEAR(map.uv[i].x, map.position[i].x, 1e-5);
      EXPECT_NEAR(map.uv[i].y, 1 - map.position[i].y, 1e-5);
      EXPECT_NEAR(map.colour[i].r, 255 * map.position[i].z, 1.5);
    }
    EXPECT_GT(seen, view.pixels() / 10);
  }
}

TEST(PositionMap, OfEquallyNearTrianglesSeesTheFirst) {
  IndexedMesh mesh = terrain_mesh(4, 0);
  const std::vector<Triangle> once = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());  // coincident surfaces
  const auto serial = make_serial_scheduler();
  const PositionMap map = rasterize_map(mesh, orthographic_view(box_of(mesh), {0, 0, -1}, 1.0 / 64), {}, *serial);
  for (std::size_t i = 0; i < map.triangle.size(); ++i) EXPECT_TRUE(!map.sees(i) || map.triangle[i] < once.size());
}

TEST(PositionMap, OfASurfaceSeenFromItsEdgeIsEmpty) {
  const IndexedMesh mesh = terrain_mesh(6, 0);
  const auto serial = make_serial_scheduler();
  const PositionMap map = rasterize_map(mesh, orthographic_view(box_of(mesh), {1, 0, 0}, 1.0 / 64), {}, *serial);
  for (std::size_t i = 0; i < map.triangle.size(); ++i) EXPECT_FALSE(map.sees(i));
}

TEST(PositionMap, RefusesViewsThatAreNone) {
  const IndexedMesh mesh = sphere_mesh(1);
  const auto serial = make_serial_scheduler();
  const MapView good = orthographic_view(box_of(mesh), {0, 0, -1}, 1.0 / 16);
  const auto refused = [&](auto change) {
    MapView view = good;
    change(view);
    EXPECT_THROW((void)rasterize_map(mesh, view, {}, *serial), InputError);
  };
  refused([](MapView& v) { v.width = 0; });
  refused([](MapView& v) { v.height = largest_map_side + 1; });
  MapView largest = good;
  largest.width = largest.height = largest_map_side;
  EXPECT_NO_THROW(check_view(largest));
  refused([](MapView& v) { v.pixel = 0; });
  refused([](MapView& v) { v.eye.x = std::nan(""); });
  refused([](MapView& v) { v.right = v.up; });
  refused([](MapView& v) { v.right = -1.0 * v.right; });
  refused([](MapView& v) { v.projection = Projection::perspective, v.eye = {0.5, 0.5, 0.5}; });
  EXPECT_THROW((void)perspective_view(box_of(mesh), {0.5, 0.5, 0.5}, 0.01), InputError);
  EXPECT_THROW((void)perspective_view(box_of(mesh), {0.9, 0.5, 0.5}, 0.01), InputError);
  EXPECT_THROW((void)orthographic_view(box_of(mesh), {0, 0, 1}, 1e-6), InputError);
  EXPECT_THROW((void)make_map_renderer("null", mesh, *serial), InputError);
}

TEST(PositionMap, OfTwiceTheResolutionHasEveryOtherPixelInPlace) {
  const IndexedMesh mesh = sphere_mesh(4);
  const auto serial = make_serial_scheduler();
  for (const MapView& view : some_views(mesh)) {
    const MapView finer = finer_view(view);
    for (const auto& [x, y] : {std::pair{0, 0}, {3, 7}, {view.width - 1, view.height - 1}}) {
      const Ray a = ray_through(view, x + 0.5, y + 0.5), b = ray_through(finer, 2 * x + 0.5, 2 * y + 0.5);
      EXPECT_LT(length(a.origin - b.origin) + length(a.direction - b.direction), 1e-12);
    }
  }
}

// A plane that is seen in every pixel, those at the border of the picture included.
TEST(CondensedMap, OfAPlaneBeyondThePictureIsThePlane) {
  const IndexedMesh square{{{0, 0, 0.5f}, {1, 0, 0.5f}, {1, 1, 0.5f}, {0, 1, 0.5f}}, {{{0, 1, 2}}, {{0, 2, 3}}}, {}};
  const auto serial = make_serial_scheduler();
  const MapView view{.eye = {0.5, 0.5, 1}, .pixel = 0.07, .width = 9, .height = 6};
  const PositionMap fine = rasterize_map(square, finer_view(view), {}, *serial);
  CondensedMap result = condensed_like(fine, view);
  condense_rows(fine, {}, 0, view.height, result);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const auto i = static_cast<std::size_t>(y * view.width + x);
      ASSERT_TRUE(result.map.sees(i));
      EXPECT_LT(length(result.vertex[i] - result.map.position[i]), 1e-6f) << x << " " << y;
      EXPECT_EQ(result.map.normal[i], (Vec3f{0, 0, 1}));
      const bool right = x + 1 < view.width, down = y + 1 < view.height;
      EXPECT_EQ(result.links[i],
                (right ? link_right : 0) | (down ? link_down : 0) | (right && down ? link_diagonal | link_across : 0));
    }
}

TEST(PositionMap, SeesTheInsideBehindAPlane) {
  const IndexedMesh mesh = sphere_mesh(4, 0);
  const auto serial = make_serial_scheduler();
  MapView view = orthographic_view(box_of(mesh), {0, 0, -1}, 1.0 / 50);
  view.nearest = view.depth({0.5, 0.5, 0.5});
  const PositionMap map = rasterize_map(mesh, view, {}, *serial);
  for (std::size_t i = 0; i < view.pixels(); ++i) {
    if (!map.sees(i)) continue;
    EXPECT_LE(map.position[i].z, 0.501f);
    EXPECT_LT(map.normal[i].z, 0.1f);  // from behind
  }
  EXPECT_TRUE(map.sees(static_cast<std::size_t>(view.height / 2 * view.width + view.width / 2)));
}

// Skips, saying what is missing, where OpenGL is not available.
TEST(PositionMap, IsTheSameFromOpenGl) {
  const auto serial = make_serial_scheduler();
  for (const IndexedMesh& mesh :
       {coloured(sphere_mesh(5)), coloured(terrain_mesh(40, 0.3)), coloured(torus_mesh(30, 17))}) {
    std::unique_ptr<MapRenderer> gl;
    try {
      gl = make_map_renderer("gl", mesh, *serial);
    } catch (const UnsupportedError& error) {
      GTEST_SKIP() << error.what();
    }
    for (const MapView& view : some_views(mesh)) {
      const PositionMap soft = rasterize_map(mesh, view, {.uv = true, .colour = true}, *serial),
                        drawn = gl->draw(view, {.uv = true, .colour = true});
      std::size_t seen = 0, other = 0;
      for (std::size_t i = 0; i < view.pixels(); ++i) {
        seen += soft.sees(i);
        if (soft.triangle[i] != drawn.triangle[i]) {
          ++other;
          continue;
        }
        EXPECT_LT(length(soft.position[i] - drawn.position[i]), 1e-6f);
        EXPECT_NEAR(soft.depth[i], drawn.depth[i], 1e-6f);
        EXPECT_LT(length(soft.normal[i] - drawn.normal[i]), 1e-6f);
        EXPECT_NEAR(soft.uv[i].x, drawn.uv[i].x, 1e-6f);
        EXPECT_LE(std::abs(soft.colour[i].r - drawn.colour[i].r), 1);
      }
      EXPECT_LE(other, seen / 500);
    }
  }
}

}  // namespace
}  // namespace lodestone::test
