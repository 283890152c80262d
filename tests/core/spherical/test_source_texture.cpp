// Textures of a source: which texels count, what lies beyond them, filters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/texture/chart_cover.h"
#include "core/texture/colour.h"
#include "core/texture/source_texture.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

constexpr TextureWrap repeat = TextureWrap::repeat, clamp = TextureWrap::clamp;

// The least distance of a point within a triangle from its edges; negative outside.
double depth(const ChartTriangle& t, double x, double y) {
  const auto cross = [](Vec2f a, Vec2f b, double px, double py) {
    const double dx = double{b.x} - a.x, dy = double{b.y} - a.y;
    return (dx * (py - a.y) - dy * (px - a.x)) / std::sqrt(dx * dx + dy * dy);
  };
  const auto& [a, b, c] = t.uv;
  const double turn = cross(a, b, c.x, c.y) < 0 ? -1 : 1;
  return std::min({turn * cross(a, b, x, y), turn * cross(b, c, x, y), turn * cross(c, a, x, y)});
}

TEST(ChartCover, CentresWithinTrianglesAreCovered) {
  test::Numbers number(4);
  const auto uv = [&] { return Vec2f{static_cast<float>(number()), static_cast<float>(number())}; };
  constexpr PixelSize size{37, 21};
  for (int k = 0; k < 300; ++k) {
    const ChartTriangle triangle{{uv(), uv(), uv()}, 0};
    const std::vector<std::uint8_t> covered = chart_cover({&triangle, 1}, size, clamp, clamp);
    if (std::ranges::count(covered, 1) < 3) continue;  // those without a centre are tested below
    for (std::uint32_t y = 0; y < size.height; ++y)
      for (std::uint32_t x = 0; x < size.width; ++x) {
        const double d = depth(triangle, (x + 0.5) / size.width, (y + 0.5) / size.height);
        EXPECT_TRUE(std::abs(d) < 1e-9 || (covered[y * size.width + x] != 0) == (d > 0)) << d;
      }
  }
}

TEST(ChartCover, ChartsWithoutACentreGetATexel) {
  const std::array<ChartTriangle, 2> two{ChartTriangle{{Vec2f{0.51f, 0.51f}, {0.52f, 0.51f}, {0.51f, 0.52f}}, 1},
                                         ChartTriangle{{Vec2f{0, 0}, {0.5f, 0}, {0, 0.5f}}, 2}};
  EXPECT_EQ(chart_cover(two, {8, 8}, clamp, clamp)[4 * 8 + 4], 1);
  // If the chart has centres elsewhere, this texel at its border does not count.
  std::array<ChartTriangle, 2> one = two;
  one[1].chart = 1;
  EXPECT_EQ(chart_cover(one, {8, 8}, clamp, clamp)[4 * 8 + 4], 0);
}

TEST(ChartCover, CoordinatesAreWrapped) {
  const ChartTriangle inside{{Vec2f{0.2f, 0.1f}, {0.9f, 0.3f}, {0.4f, 0.8f}}, 0};
  ChartTriangle moved = inside, turned = inside;
  for (Vec2f& uv : moved.uv) uv = {uv.x + 3, uv.y - 2};
  std::swap(turned.uv[0], turned.uv[1]);
  const auto expected = chart_cover({&inside, 1}, {16, 16}, repeat, repeat);
  EXPECT_EQ(chart_cover({&moved, 1}, {16, 16}, repeat, repeat), expected);
  EXPECT_EQ(chart_cover({&turned, 1}, {16, 16}, repeat, repeat), expected);
  const ChartTriangle vast{{Vec2f{0, 0}, {1e30f, 0}, {0, 1e30f}}, 0};
  EXPECT_EQ(std::ranges::count(chart_cover({&vast, 1}, {16, 16}, repeat, repeat), 1), 256);
}

TEST(ChartCover, RingsGrowByOneTexel) {
  constexpr std::uint32_t n = 15;
  std::vector<std::uint8_t> start(n * n);
  std::vector<int> value(n * n), from(n * n);
  for (const std::size_t texel : {std::size_t{20}, std::size_t{100}, std::size_t{101}}) start[texel] = 1;
  const auto index = [](std::int64_t x, std::int64_t y) {
    const auto in = [](std::int64_t v) { return std::clamp<std::int64_t>(v, 0, n - 1); };
    return static_cast<std::size_t>(in(y)*n + in(x));
  };
  for (const std::size_t rings : {0u, 1u, 4u, 100u}) {
    std::vector<std::uint8_t> covered = start;
    const std::size_t made = extend_cover(covered, {n, n}, rings, index, [](auto, std::size_t) {});
    EXPECT_LE(made, rings);
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x) {
        std::int64_t distance = 100;
        for (std::int64_t t = 0; t < n * n; ++t)
          if (start[static_cast<std::size_t>(t)] != 0)
            distance = std::min(distance, std::max(std::abs(t % n - x), std::abs(t / n - y)));
        EXPECT_EQ(covered[static_cast<std::size_t>(y * n + x)], distance <= static_cast<std::int64_t>(rings));
      }
  }
}

// One colour within the left part, another outside.
SourceTexture half_covered(std::uint32_t n) {
  PixelImage image{.size = {n, n}, .channels = 3, .pixels = {}};
  std::vector<std::uint8_t> covered;
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      covered.push_back(x < n / 2 - 1);
      for (const int c : {200, 100, 50})
        image.pixels.push_back(static_cast<std::uint8_t>(covered.back() != 0 ? c : 255 - c));
    }
  return {image, PixelMeaning::colours, clamp, clamp, covered};
}

TEST(SourceTexture, FiltersFindNoBackground) {
  for (const std::uint32_t n : {32u, 37u, 64u}) {
    const SourceTexture texture = half_covered(n);
    test::Numbers number(n);
    for (int k = 0; k < 2000; ++k) {
      const auto u = static_cast<float>(0.5 * number()), v = static_cast<float>(number());
      const auto side = static_cast<float>(0.1 * number()), other = static_cast<float>(0.1 * number());
      const Float4 value = texture.filtered({{u, v}, {0, side}, {other / static_cast<float>(n), 0}});
      EXPECT_NEAR(value[0], srgb_to_linear(200.0 / 255), 2e-4);
      EXPECT_NEAR(value[2], srgb_to_linear(50.0 / 255), 2e-4);
      EXPECT_NEAR(value[3], 1, 1e-5);
    }
  }
}

TEST(SourceTexture, LightIsAveragedWithItsAlpha) {
  // White without alpha beside black: the mean is black and half transparent.
  PixelImage image{.size = {2, 1}, .channels = 4, .pixels = {255, 255, 255, 0, 0, 0, 0, 255}};
  const SourceTexture alpha(image, PixelMeaning::colours, repeat, repeat, {1, 1});
  const Float4 mean = alpha.filtered({{0.5f, 0.5f}, {}, {}});
  EXPECT_NEAR(mean[0], 0, 1e-6);
  EXPECT_NEAR(mean[3], 0.5, 1e-5);
  // White beside black is half of the light, at any level.
  PixelImage checker{.size = {64, 64}, .channels = 1, .pixels = {}};
  for (int i = 0; i < 64 * 64; ++i) checker.pixels.push_back((i / 64 + i) % 2 == 0 ? 255 : 0);
  const SourceTexture grey(checker, PixelMeaning::colours, repeat, repeat, std::vector<std::uint8_t>(64 * 64, 1));
  for (const float side : {0.0625f, 0.125f, 1.0f, 30.0f})
    EXPECT_NEAR(grey.filtered({{0.3f, 0.7f}, {side, 0}, {0, side}})[0], 0.5, 1e-4);
}

// Footprints of a power of two texels, any ratio of sides, on a ramp: the value in the middle.
TEST(SourceTexture, FootprintsAreAveraged) {
  constexpr std::uint32_t n = 128;
  PixelImage image{.size = {n, n}, .channels = 3, .pixels = {}};
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x)
      image.pixels.insert(image.pixels.end(),
                          {static_cast<std::uint8_t>(2 * x), static_cast<std::uint8_t>(2 * y), 128});
  const SourceTexture texture(image, PixelMeaning::normals, clamp, clamp, std::vector<std::uint8_t>(n * n, 1));
  for (const float x : {0.5f, 1.0f, 4.0f, 16.0f})
    for (const float y : {0.5f, 2.0f, 16.0f}) {
      const Float4 value = texture.filtered({{0.5f, 0.25f}, {x / n, 0}, {0, y / n}});
      EXPECT_NEAR(value[0], 2 * (n - 1.0) / 255 - 1, 0.01) << x << ' ' << y;
      EXPECT_NEAR(value[1], (n - 2.0) / 255 - 1, 0.01) << x << ' ' << y;
      EXPECT_NEAR(value[2], 0, 0.005);
    }
}

// Lanes and plain loops, across the borders of the image and within, from a texel to all of them.
TEST(SourceTexture, TapsOfFourFootprintsGiveTheSameValues) {
  const SourceTexture texture = half_covered(24), other = half_covered(32);
  EXPECT_TRUE(texture.has_taps_of(half_covered(24)));
  EXPECT_FALSE(texture.has_taps_of(other));
  test::Numbers number(8);
  TapList taps;
  for (int k = 0; k < 1000; ++k) {
    const auto lanes = [&](double scale, double shift) {
      Float4 v{};
      for (int lane = 0; lane < 4; ++lane) v[lane] = static_cast<float>(shift + scale * (number() - 0.5));
      return v;
    };
    const double around = k % 2 == 0 ? 4 : 0.5, side = k % 3 == 0 ? 0.01 : k % 3 == 1 ? 0.3 : 2;
    const Footprint4 footprints{lanes(around, 0.5), lanes(around, 0.5), lanes(side, 0),
                                lanes(side, 0),     lanes(side, 0),     lanes(0.1, 0)};
    const auto count = static_cast<std::size_t>(1 + k % 4);
    std::uint32_t begin = static_cast<std::uint32_t>(taps.count);
    const std::array<std::uint32_t, 4> ends = texture.add_taps(footprints, count, taps);
    for (std::size_t lane = 0; lane < count; begin = ends[lane++]) {
      const Float4 value = texture.value(taps.between(begin, ends[lane]));
      const Float4 expected = texture.filtered(footprints.lane(lane));
      for (int c = 0; c < 4; ++c) EXPECT_EQ(value[c], expected[c]);
    }
    EXPECT_EQ(begin, taps.count);
  }
}

}  // namespace
}  // namespace lodestone::spherical
