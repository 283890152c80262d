// Heat maps: every pixel has the colour that the bar has at its value, and brighter is worse.
#include <gtest/gtest.h>

#include "experiments/metrics/pictures/heat_map.h"

namespace lodestone {
namespace {

ErrorMap ramp(int width, int height, float most) {
  ErrorMap map{{width, height}, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) map.value.push_back(most * static_cast<float>(x) / static_cast<float>(width - 1));
  return map;
}

std::array<int, 3> colour(const Image& image, int x, int y) {
  const std::size_t at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.width) + static_cast<std::size_t>(x));
  return {image.rgba[at], image.rgba[at + 1], image.rgba[at + 2]};
}

TEST(HeatMap, TopIsRoundAndFitsTheErrors) {
  for (const auto& [most, top] :
       {std::pair{0.9F, 1.0}, {0.5F, 0.5}, {0.05F, 0.05}, {0.3F, 0.5}, {0.011F, 0.02}, {1e-4F, 1e-4}, {0.0F, 1.0}})
    EXPECT_NEAR(heat_map_top(ramp(100, 1, most)), top, 1e-9 + 1e-6 * top) << most;
  ErrorMap speck = ramp(100, 100, 0);
  speck.value[77] = 0.3F;
  EXPECT_EQ(heat_map_top(speck), 0.5) << "errors that few pixels have set the range where no others are";
  for (float& v : speck.value) v = std::max(v, 0.009F);
  EXPECT_EQ(heat_map_top(speck), 0.01) << "a speck does not darken the rest";
  EXPECT_EQ(heat_map_top({{0, 0}, {}}), 1);
}

TEST(HeatMap, PixelsHaveTheColoursOfTheBar) {
  const int width = 301, height = 4;
  const Image image = heat_map(ramp(width, height, 0.05F));
  ASSERT_EQ(image.size.width, width);
  ASSERT_EQ(image.size.height, height + heat_bar_gap + heat_bar_height + heat_label_height);
  int before = -1;
  for (int x = 0; x < width; ++x) {
    const auto here = colour(image, x, 0), bar = colour(image, x, height + heat_bar_gap);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(here[c], bar[c], 1) << x;
    const int grey = here[0] * 299 + here[1] * 587 + here[2] * 114;
    EXPECT_GT(grey, before) << "a larger error is brighter, " << x;
    before = grey;
  }
}

TEST(HeatMap, OfAGivenTopWithTheBarOrWithout) {
  const ErrorMap map = ramp(30, 4, 0.05F);
  const Image bare = heat_colours(map, 0.5), whole = heat_map(map, 0.5);
  EXPECT_EQ(bare.size, map.size);
  EXPECT_TRUE(std::equal(bare.rgba.begin(), bare.rgba.end(), whole.rgba.begin()));
  EXPECT_EQ(heat_colours(map, heat_map_top(map)).rgba, heat_colours(map, 0.05).rgba);
  for (int x = 1; x < 30; ++x) EXPECT_LT(colour(bare, x, 0)[1], 255 / 4) << "a tenth of the top at most";
}

TEST(HeatMap, BarSaysWhereItEnds) {
  const auto lit = [](const Image& image, int left, int right) {
    int count = 0;
    for (int y = image.size.height - heat_label_height; y < image.size.height; ++y)
      for (int x = left; x < right; ++x) count += colour(image, x, y)[0] == 255 ? 1 : 0;
    return count / 9;  // a glyph's pixel is three by three
  };
  const Image image = heat_map(ramp(400, 2, 0.02F));
  EXPECT_EQ(lit(image, 0, 100), 12) << "0";
  EXPECT_EQ(lit(image, 100, 300), 12 + 1 + 12 + 8) << "0.01";
  EXPECT_EQ(lit(image, 300, 400), 12 + 1 + 12 + 11 + 5) << "0.02+";
  EXPECT_EQ(lit(heat_map(ramp(400, 2, 5e-5F)), 300, 400), 11 + 9 + 3 + 12 + 11 + 5) << "5e-05+";
  EXPECT_EQ(heat_map(ramp(2, 1, 0.02F)).size.width, 2) << "labels are clipped to a small picture";
}

}  // namespace
}  // namespace lodestone
