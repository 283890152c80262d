// Coverage of triangles: watertight, and the same as a slow obvious twin.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "render/backends/soft/edge_walk.h"

namespace lodestone::soft {
namespace {

constexpr int width = 96, height = 80;
constexpr PixelRect canvas{0, 0, width, height};
using Counts = std::vector<int>;

// How often each pixel is drawn, in either orientation.
void draw(SnappedPoint a, SnappedPoint b, SnappedPoint c, PixelRect clip, Counts& counts) {
  const std::int64_t area = doubled_area(a, b, c);
  if (area == 0) return;
  if (area < 0) std::swap(b, c);
  for_each_covered(a, b, c, covered_box(a, b, c, clip),
                   [&](int x, int y, auto, auto) { ++counts[static_cast<std::size_t>(y * width + x)]; });
}

// The twin: the top-left rule as what it means. The sample moves by an infinitesimal step to the right and a much
// smaller one downwards; then it lies on no edge any more and is inside where all three edge functions are positive.
bool covered_by_definition(SnappedPoint a, SnappedPoint b, SnappedPoint c, int x, int y) {
  if (doubled_area(a, b, c) < 0) std::swap(b, c);
  const auto positive = [&](SnappedPoint from, SnappedPoint to) {
    const auto value =
        static_cast<__int128>(doubled_area(from, to, {x * subpixels + subpixels / 2, y * subpixels + subpixels / 2}));
    constexpr __int128 infinity = __int128{1} << 40;
    const std::int64_t dx = to.x - from.x, dy = to.y - from.y;
    return value * infinity * infinity - dy * infinity + dx > 0;
  };
  return positive(a, b) && positive(b, c) && positive(c, a);
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  int in(int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(engine_); }
  SnappedPoint point(int margin) {
    SnappedPoint p{in(-margin, width + margin) * subpixels, in(-margin, height + margin) * subpixels};
    // Half of them on pixel centres or corners, where the rule decides.
    if (in(0, 1))
      p.x += in(0, subpixels - 1), p.y += in(0, subpixels - 1);
    else
      p.x += subpixels / 2 * in(0, 1), p.y += subpixels / 2 * in(0, 1);
    return p;
  }

 private:
  std::mt19937 engine_;
};

TEST(EdgeWalk, EqualsItsDefinition) {
  Random random(1);
  for (int i = 0; i < 400; ++i) {
    // Small ones, which are walked in 32 bits, those just too large for that, and some 20,000 pixels long.
    const int margin = std::array{10, 20, 300, 20000}[static_cast<std::size_t>(i % 4)];
    const SnappedPoint a = random.point(margin), b = random.point(margin), c = random.point(i % 8 < 4 ? margin : 10);
    if (doubled_area(a, b, c) == 0) continue;
    Counts counts(width * height);
    draw(a, b, c, canvas, counts);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(counts[static_cast<std::size_t>(y * width + x)], covered_by_definition(a, b, c, x, y)) << i;
  }
}

TEST(EdgeWalk, SharesAreBarycentric) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    SnappedPoint a = random.point(30), b = random.point(30), c = random.point(30);
    const std::int64_t area = doubled_area(a, b, c);
    if (area <= 0) continue;
    for_each_covered(a, b, c, covered_box(a, b, c, canvas), [&](int x, int y, auto edge_b, auto edge_c) {
      const std::int64_t share_b = edge_b, share_c = edge_c, share_a = area - share_b - share_c;
      ASSERT_GE(share_a, 0);
      ASSERT_GE(share_b, 0);
      ASSERT_GE(share_c, 0);
      ASSERT_EQ(share_a * a.x + share_b * b.x + share_c * c.x, area * (x * subpixels + subpixels / 2));
      ASSERT_EQ(share_a * a.y + share_b * b.y + share_c * c.y, area * (y * subpixels + subpixels / 2));
    });
  }
}

// A fan around a point, closed by a polygon that goes once around the canvas: every pixel exactly once.
TEST(EdgeWalk, ClosedFanCoversEveryPixelOnce) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const SnappedPoint hub = random.point(-20);
    std::vector<SnappedPoint> rim;
    const int left = -3 * subpixels, right = (width + 3) * subpixels, top = -3 * subpixels,
              bottom = (height + 3) * subpixels;
    const auto side = [&](SnappedPoint from, SnappedPoint to, int parts) {
      for (int k = 0; k < parts; ++k)
        rim.push_back({from.x + (to.x - from.x) * k / parts, from.y + (to.y - from.y) * k / parts});
    };
    side({left, top}, {right, top}, random.in(1, 9));
    side({right, top}, {right, bottom}, random.in(1, 9));
    side({right, bottom}, {left, bottom}, random.in(1, 9));
    side({left, bottom}, {left, top}, random.in(1, 9));
    Counts counts(width * height);
    for (std::size_t k = 0; k < rim.size(); ++k) draw(hub, rim[k], rim[(k + 1) % rim.size()], canvas, counts);
    EXPECT_TRUE(std::ranges::all_of(counts, [](int n) { return n == 1; })) << i;
  }
}

// A jittered grid of small triangles, most of them smaller than a pixel: no pixel twice, none missed.
TEST(EdgeWalk, TriangulationCoversEveryPixelOnce) {
  Random random(4);
  for (const int step : {97, 150, 256, 1000}) {  // subpixels
    const int columns = width * subpixels / step + 3, rows = height * subpixels / step + 3;
    std::vector<SnappedPoint> grid;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        grid.push_back({(i - 1) * step + random.in(0, step / 3), (j - 1) * step + random.in(0, step / 3)});
    Counts counts(width * height);
    const auto at = [&](int i, int j) { return grid[static_cast<std::size_t>(j * columns + i)]; };
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < columns; ++i) {
        const bool flip = random.in(0, 1);
        draw(at(i, j), at(i + 1, j), flip ? at(i, j + 1) : at(i + 1, j + 1), canvas, counts);
        draw(flip ? at(i + 1, j) : at(i, j), at(i + 1, j + 1), at(i, j + 1), canvas, counts);
      }
    EXPECT_TRUE(std::ranges::all_of(counts, [](int n) { return n == 1; })) << step;
  }
}

TEST(EdgeWalk, TilesOfThePictureDrawTheSame) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const int margin = i % 2 ? 60 : 5000;
    const SnappedPoint a = random.point(margin), b = random.point(margin), c = random.point(margin);
    Counts whole(width * height), tiled(width * height);
    draw(a, b, c, canvas, whole);
    for (int y = 0; y < height; y += 16)
      for (int x = 0; x < width; x += 32) draw(a, b, c, {x, y, x + 32, y + 16}, tiled);
    EXPECT_EQ(whole, tiled);
  }
}

TEST(EdgeWalk, BoxOfATriangleBetweenPixelCentresIsEmpty) {
  EXPECT_TRUE(empty(covered_box({130, 130}, {300, 140}, {200, 380}, canvas)));
  EXPECT_FALSE(empty(covered_box({128, 128}, {300, 140}, {200, 380}, canvas)));
  EXPECT_TRUE(empty(covered_box({-900, -900}, {-300, -140}, {-200, -380}, canvas)));
}

}  // namespace
}  // namespace lodestone::soft
