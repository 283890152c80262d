// Octahedral images: continuation beyond the sides, symmetry of every level, sampling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

LinearImage noise(std::uint32_t n, std::uint32_t channels) {
  test::Numbers number(n);
  LinearImage image{{n, n}, channels, std::vector<float>(std::size_t{n} * n * channels)};
  for (float& v : image.values) v = static_cast<float>(number());
  if (channels == 4)
    for (std::size_t p = 0; p < image.values.size(); p += 4)
      for (std::size_t c = 0; c < 3; ++c) image.values[p + c] *= image.values[p + 3];
  return image;
}

template <class Value>
bool is_symmetric(const std::vector<Value>& values, std::size_t n, std::size_t channels) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < channels; ++c) {
      const auto at = [&](std::size_t x, std::size_t y) { return values[(y * n + x) * channels + c]; };
      const std::size_t last = n - 1;
      if (at(i, 0) != at(last - i, 0) || at(i, last) != at(last - i, last) || at(0, i) != at(0, last - i) ||
          at(last, i) != at(last, last - i) || at(0, 0) != at(last, last))
        return false;
    }
  return true;
}

// A path that crosses a side goes on, on the sphere, as the continuation says.
TEST(OctahedralImage, ContinuationFollowsTheSphere) {
  constexpr std::int64_t n = 64;
  const auto centre = [](Texel p) {
    return direction_of({(static_cast<double>(p.x) + 0.5) / n, (static_cast<double>(p.y) + 0.5) / n});
  };
  for (std::int64_t i = 0; i < n; ++i)
    for (const auto& [inside, outside] :
         {std::pair<Texel, Texel>{{i, 0}, {i, -1}}, {{i, n - 1}, {i, n}}, {{0, i}, {-1, i}}, {{n - 1, i}, {n, i}}}) {
      const Texel other = continued(outside, n);
      ASSERT_TRUE(other.x >= 0 && other.x < n && other.y >= 0 && other.y < n);
      EXPECT_LT(length(centre(other) - centre(inside)), 2.0 / n * 2.2);
      EXPECT_NEAR(std::abs(centre(other).x), std::abs(centre(inside).x), 1e-15);
      EXPECT_EQ(continued(inside, n), inside);
    }
  for (const Texel corner : {Texel{-1, -1}, Texel{n, n}, Texel{-1, n}, Texel{n, -1}}) {
    const Texel other = continued(corner, n);
    EXPECT_TRUE((other.x == 0 || other.x == n - 1) && (other.y == 0 || other.y == n - 1));
  }
}

// By sets of texels that mirror each other, gathered one by one.
TEST(OctahedralImage, BorderIsTheMeanOfMirroredTexels) {
  for (const std::uint32_t n : {1u, 2u, 3u, 4u, 7u, 16u}) {
    const LinearImage before = noise(n, 3);
    LinearImage after = before;
    average_border(after);
    EXPECT_TRUE(is_symmetric(after.values, n, 3)) << n;
    const std::int64_t last = n - 1;
    for (std::int64_t y = 0; y <= last; ++y)
      for (std::int64_t x = 0; x <= last; ++x) {
        std::set<std::pair<std::int64_t, std::int64_t>> same{{x, y}};
        for (int again = 0; again < 3; ++again)
          for (const auto& [a, b] : std::set(same)) {
            if (b == 0 || b == last) same.insert({last - a, b});
            if (a == 0 || a == last) same.insert({a, last - b});
          }
        for (std::size_t c = 0; c < 3; ++c) {
          double sum = 0;
          for (const auto& [a, b] : same) sum += before.values[static_cast<std::size_t>(b * n + a) * 3 + c];
          EXPECT_NEAR(after.values[static_cast<std::size_t>(y * n + x) * 3 + c], sum / double(same.size()), 1e-6);
        }
      }
  }
  LinearImage oblong{{4, 2}, 1, std::vector<float>(8)};
  EXPECT_THROW(average_border(oblong), InputError);
}

TEST(OctahedralImage, EveryLevelIsSymmetricInItsBytes) {
  for (const std::uint32_t n : {64u, 33u, 5u})
    for (const std::uint32_t channels : {3u, 4u})
      for (const PixelMeaning meaning : {PixelMeaning::colours, PixelMeaning::normals}) {
        const std::vector<PixelImage> levels = symmetric_levels(noise(n, channels), meaning);
        EXPECT_EQ(levels.front().size.width, n);
        EXPECT_EQ(levels.back().size, (PixelSize{1, 1}));
        for (const PixelImage& level : levels)
          EXPECT_TRUE(is_symmetric(level.pixels, level.size.width, channels)) << level.size.width;
      }
}

TEST(OctahedralImage, DecodedImagesAreMadeSymmetricAgain) {
  const std::vector<PixelImage> levels = symmetric_levels(noise(64, 3), PixelMeaning::colours);
  PixelImage decoded = decode_image(encode_image(levels.front(), "image/jpeg"), "image/jpeg");
  EXPECT_FALSE(is_symmetric(decoded.pixels, 64, 3));
  copy_border(std::span(decoded.pixels), 64, 3);
  EXPECT_TRUE(is_symmetric(decoded.pixels, 64, 3));
  PixelImage exact = levels.front();
  copy_border(std::span(exact.pixels), 64, 3);
  EXPECT_EQ(exact, levels.front());
  for (const std::size_t n : {1u, 2u, 3u}) {
    LinearImage small = noise(static_cast<std::uint32_t>(n), 2);
    copy_border(std::span(small.values), n, 2);
    EXPECT_TRUE(is_symmetric(small.values, n, 2));
  }
}

// Clamping a symmetric image, as every viewer does, is sampling it with its continuation.
TEST(OctahedralImage, ClampingASymmetricImageIsSeamless) {
  constexpr std::uint32_t n = 16;
  LinearImage image = noise(n, 3);
  average_border(image);
  const auto clamped = [&](SquarePoint p, std::size_t c) {
    const double x = p.s * n - 0.5, y = p.t * n - 0.5;
    const auto texel = [&](double i, double j) {
      const auto at = [&](double k) { return static_cast<std::size_t>(std::clamp(k, 0.0, n - 1.0)); };
      return double{image.values[(at(j) * n + at(i)) * 3 + c]};
    };
    const double a = x - std::floor(x), b = y - std::floor(y), i = std::floor(x), j = std::floor(y);
    return (1 - b) * ((1 - a) * texel(i, j) + a * texel(i + 1, j)) +
           b * ((1 - a) * texel(i, j + 1) + a * texel(i + 1, j + 1));
  };
  test::Numbers number(3);
  for (int k = 0; k < 10'000; ++k) {
    const SquarePoint p{number(), number()};
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sample(image, p)[c], clamped(p, c), 1e-6);
    for (const auto& [a, b] : {std::pair<SquarePoint, SquarePoint>{{p.s, 0}, {1 - p.s, 0}}, {{1, p.t}, {1, 1 - p.t}}})
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(clamped(a, c), clamped(b, c), 1e-6);
  }
}

}  // namespace
}  // namespace lodestone::spherical
