// Small octahedral images in one: where they are, and that filters find in the atlas what they find in the image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/octahedron/square_atlas.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

const std::vector<std::uint32_t> sides{16, 64, 16, 32, 16, 128, 16, 32, 16};

LinearImage symmetric_noise(std::uint32_t n, int seed) {
  test::Numbers number(seed);
  LinearImage image{{n, n}, 3, std::vector<float>(std::size_t{3} * n * n)};
  for (float& value : image.values) value = static_cast<float>(number());
  average_border(image);
  return image;
}

TEST(SquareAtlas, SquaresDoNotOverlap) {
  const SquareAtlas atlas = pack_squares(sides, 1024);
  std::uint64_t area = 0;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const AtlasSquare& a = atlas.squares[k];
    EXPECT_EQ(a.side, sides[k]);
    EXPECT_LE(std::max(a.x, a.y) + a.side, atlas.side);
    EXPECT_TRUE(a.x % a.side == 0 && a.y % a.side == 0);  // its levels are its own
    area += a.side * a.side;
    for (std::size_t l = 0; l < k; ++l) {
      const AtlasSquare& b = atlas.squares[l];
      EXPECT_TRUE(a.x + a.side <= b.x || b.x + b.side <= a.x || a.y + a.side <= b.y || b.y + b.side <= a.y);
    }
  }
  EXPECT_LT(atlas.side * atlas.side, 4 * area);
}

TEST(SquareAtlas, SquaresAreHalvedUntilTheyFit) {
  const SquareAtlas half = pack_squares(sides, 128), least = pack_squares(sides, 16);
  EXPECT_EQ(half.side, 128u);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    EXPECT_EQ(half.squares[k].side, std::max(sides[k] / 2, 16u));
    EXPECT_EQ(least.squares[k].side, 16u);
  }
  EXPECT_EQ(least.side, 64u);
}

// Between texels, as clamped images are read.
float interpolated(const LinearImage& image, double s, double t) {
  const double x = s * image.size.width - 0.5, y = t * image.size.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  double sum = 0;
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const auto at = static_cast<std::size_t>(top + j) * image.size.width + static_cast<std::size_t>(left + i);
      sum += (i == 0 ? 1 - (x - left) : x - left) * (j == 0 ? 1 - (y - top) : y - top) * image.values[3 * at];
    }
  return static_cast<float>(sum);
}

TEST(SquareAtlas, FiltersFindTheImageAndWhatContinuesIt) {
  const SquareAtlas squares = pack_squares(sides, 1024);
  LinearImage atlas = blank_image(squares, 3);
  for (std::size_t k = 0; k < sides.size(); ++k)
    paste(symmetric_noise(squares.squares[k].image(), static_cast<int>(k)), squares.squares[k], atlas);
  fill_rest(squares, atlas);
  EXPECT_NEAR(atlas.values.back(), 0.5, 0.1);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const LinearImage image = symmetric_noise(squares.squares[k].image(), static_cast<int>(k));
    EXPECT_EQ(cut_out(atlas, squares.squares[k]).values, image.values);
    const ImagePlace place = place_in(squares, k, 7);
    EXPECT_EQ(place.material, 7u);
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; j <= 40; ++j) {
        const SquarePoint p{i / 40.0, j / 40.0}, at = place.of(p);
        EXPECT_NEAR(interpolated(atlas, at.s, at.t), sample(image, p)[0], 1e-4);
      }
  }
}

}  // namespace
}  // namespace lodestone::spherical
