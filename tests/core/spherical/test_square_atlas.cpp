// Small octahedral images in one: where they are, and that filters find in the atlas what they find in the image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/files/json_view.h"
#include "core/progressive/mesh/octahedral_layout.h"
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

TEST(SquareAtlas, LayoutsGiveTheSquares) {
  const SquareAtlas atlas = pack_squares(sides, 1024);
  const OctahedralLayout layout = layout_of(atlas);
  EXPECT_EQ(layout, (OctahedralLayout{256, {{128, 1}, {64, 1}, {32, 2}, {16, 5}}}));
  std::vector<AtlasSquare> squares = squares_of(layout, atlas.side);
  EXPECT_TRUE(std::ranges::is_permutation(squares, atlas.squares));
  squares = squares_of(layout, atlas.side / 4);  // those of 16 have 4 texels there
  ASSERT_EQ(squares.size(), 4u);
  EXPECT_EQ(squares[1], (AtlasSquare{32, 0, 16}));
}

// Bytes of an atlas at one level, with the squares that have at least so many texels there.
struct AtlasLevel {
  const PixelImage& pixels;
  std::uint32_t divisor;
  [[nodiscard]] bool same(const AtlasSquare& square, Texel a, Texel b) const {
    const auto texel = [&](Texel p) {
      const auto at = [&](std::uint32_t first, std::int64_t k) {
        return static_cast<std::size_t>(first / divisor + k);
      };
      return &pixels.pixels[(at(square.y, p.y) * pixels.size.width + at(square.x, p.x)) * pixels.channels];
    };
    return std::equal(texel(a), texel(a) + pixels.channels, texel(b));
  }
  // Margins continue the image; a square of 4 texels is symmetric.
  [[nodiscard]] bool is_seamless(const AtlasSquare& square) const {
    const std::int64_t side = square.side / divisor, margin = side / 8, n = side - 2 * margin;
    bool seamless = true;
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t x = 0; x < side; ++x) {
        if (side == 4) {
          if (x == 0 || x == 3) seamless &= same(square, {x, y}, {x, 3 - y});
          if (y == 0 || y == 3) seamless &= same(square, {x, y}, {3 - x, y});
        } else {
          const Texel from = continued({x - margin, y - margin}, n);
          seamless &= same(square, {x, y}, {from.x + margin, from.y + margin});
        }
      }
    return seamless;
  }
};

// To the last bit, at every level that keeps squares apart.
TEST(SquareAtlas, LevelsAreSeamlessAfterALossyCode) {
  const SquareAtlas squares = pack_squares(sides, 1024);
  for (const PixelMeaning meaning : {PixelMeaning::colours, PixelMeaning::normals}) {
    LinearImage atlas = blank_image(squares, 3);
    for (std::size_t k = 0; k < sides.size(); ++k)
      paste(symmetric_noise(squares.squares[k].image(), static_cast<int>(k)), squares.squares[k], atlas);
    fill_rest(squares, atlas);
    PixelImage pixels = decode_image(encode_image(to_pixels(atlas, meaning), "image/jpeg"), "image/jpeg");
    EXPECT_FALSE((AtlasLevel{pixels, 1}.is_seamless(squares.squares[0])));  // of 16; JPEG mirrors blocks of larger ones
    continue_squares(std::span(pixels.pixels), squares.side, 3, layout_of(squares));
    LinearImage values = to_linear(pixels, meaning);
    for (std::uint32_t divisor = 1; divisor <= 32; divisor *= 2) {
      for (const AtlasSquare& square : squares.squares) {
        const bool seamless = square.side / divisor < 4 || AtlasLevel{pixels, divisor}.is_seamless(square);
        EXPECT_TRUE(seamless) << square.side << ' ' << divisor;
      }
      values = halve(values);
      pixels = to_pixels(values, meaning);
    }
  }
}

TEST(SquareAtlas, RefusesLayoutsThatDoNotFit) {
  const std::string file = "file";
  for (const char* const wrong :
       {"false", "1", "{}", R"({"side":256})", R"({"side":256,"squares":[]})", R"({"side":250,"squares":[[16,1]]})",
        R"({"side":131072,"squares":[[16,1]]})", R"({"side":256,"squares":[[24,1]]})",
        R"({"side":256,"squares":[[16,1],[32,1]]})", R"({"side":64,"squares":[[32,4],[16,1]]})",
        R"({"side":64,"squares":[[16,17]]})", R"({"side":64,"squares":[[0,1]]})"}) {
    const Json json = Json::parse(wrong);
    EXPECT_THROW((void)read_octahedral_layout(JsonView(json, file)), InputError) << wrong;
  }
  for (const OctahedralLayout& layout : {OctahedralLayout{}, OctahedralLayout{64, {{32, 3}, {16, 4}}}})
    EXPECT_EQ(read_octahedral_layout(JsonView(to_json(layout), file)), layout);
}

}  // namespace
}  // namespace lodestone::spherical
