// Pictures: files, sheets, differences.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/base/error.h"
#include "render/frame/image.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

Image noise(ImageSize size, unsigned seed) {
  std::mt19937 random(seed);
  Image image{size, {}, {}};
  for (int i = 0; i < size.width * size.height * 4; ++i) image.rgba.push_back(static_cast<std::uint8_t>(random()));
  return image;
}

Image flat(ImageSize size, std::uint8_t value) {
  Image image{size, {}, {}};
  image.rgba.assign(static_cast<std::size_t>(size.width * size.height * 4), value);
  return image;
}

std::string temporary(const std::string& name) { return ::testing::TempDir() + "lodestone_image_" + name; }

TEST(Png, RoundTripIsExactAndRepeatable) {
  for (const ImageSize size : {ImageSize{1, 1}, ImageSize{37, 23}, ImageSize{200, 3}}) {
    const Image image = noise(size, 1);
    write_png(temporary("a.png"), image);
    write_png(temporary("b.png"), image);
    const Image again = read_png(temporary("a.png"));
    EXPECT_EQ(again.size, size);
    EXPECT_EQ(again.rgba, image.rgba);
    EXPECT_EQ(content(temporary("a.png")), content(temporary("b.png")));
  }
}

TEST(Png, ErrorsNameTheFile) {
  EXPECT_THROW(write_png(temporary("none.png"), Image{{0, 0}, {}, {}}), InputError);
  EXPECT_THROW(write_png(temporary("short.png"), Image{{2, 2}, {1, 2, 3}, {}}), InputError);
  EXPECT_THROW(write_png("/nonexistent/folder/a.png", noise({2, 2}, 1)), FileError);
  EXPECT_THROW((void)read_png(temporary("missing.png")), FileError);
  std::ofstream(temporary("text.png")) << "no picture at all";
  EXPECT_THROW((void)read_png(temporary("text.png")), InputError);
  write_png(temporary("whole.png"), noise({64, 64}, 2));
  const std::string bytes = content(temporary("whole.png"));
  std::ofstream(temporary("cut.png"), std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  expect_error_of<InputError>([] { return read_png(temporary("cut.png")); }, {"cut.png"});
}

TEST(Downscale, AveragesWhatAPixelCovers) {
  Image image{{4, 2}, {}, {}};
  for (const int v : {0, 100, 200, 200, 100, 200, 0, 200})
    for (int c = 0; c < 4; ++c) image.rgba.push_back(static_cast<std::uint8_t>(v));
  const Image half = downscale(image, {2, 1});
  EXPECT_EQ(half.rgba[0], 100);
  EXPECT_EQ(half.rgba[4], 150);
  // Three columns over four: the middle one takes halves of the two middle ones.
  const Image third = downscale(image, {3, 2});
  EXPECT_EQ(third.rgba[0], 25);   // (0 + 100 / 3) over 4 / 3
  EXPECT_EQ(third.rgba[4], 150);  // (100 * 2 / 3 + 200 * 2 / 3) over 4 / 3
  EXPECT_EQ(downscale(image, {4, 2}).rgba, image.rgba);
  EXPECT_EQ(downscale(flat({97, 31}, 77), {13, 7}).rgba, flat({13, 7}, 77).rgba);
  EXPECT_THROW((void)downscale(image, {5, 2}), InputError);
  EXPECT_THROW((void)downscale(image, {0, 1}), InputError);
}

TEST(ContactSheet, PlacesFramesRowByRow) {
  std::vector<Image> frames;
  for (int i = 0; i < 5; ++i) frames.push_back(flat({40, 20}, static_cast<std::uint8_t>(10 * i + 5)));
  const Image sheet = contact_sheet(frames, {3, 1000, 2});
  EXPECT_EQ(sheet.size, (ImageSize{3 * 42 + 2, 2 * 22 + 2}));
  const auto at = [&](int x, int y) { return sheet.rgba[static_cast<std::size_t>(4 * (y * sheet.size.width + x))]; };
  for (int i = 0; i < 5; ++i) {
    const int left = 2 + i % 3 * 42, top = 2 + i / 3 * 22;
    for (const int x : {left, left + 39})
      for (const int y : {top, top + 19}) EXPECT_EQ(at(x, y), 10 * i + 5);
  }
  EXPECT_EQ(at(0, 0), at(100, 40));  // the gap and the empty place
}

TEST(ContactSheet, ScalesDownToTheWidth) {
  const std::vector<Image> frames(7, flat({160, 90}, 9));
  const Image sheet = contact_sheet(frames, {0, 200, 4});
  EXPECT_LE(sheet.size.width, 200);
  EXPECT_GT(sheet.size.width, 150);
  EXPECT_EQ(contact_sheet(std::vector<Image>(1, flat({30, 30}, 1))).size, (ImageSize{38, 38}));
}

TEST(ContactSheet, RefusesWhatDoesNotFit) {
  EXPECT_THROW((void)contact_sheet({}), InputError);
  EXPECT_THROW((void)contact_sheet(std::vector<Image>{flat({4, 4}, 1), flat({4, 5}, 1)}), InputError);
  EXPECT_THROW((void)contact_sheet(std::vector<Image>(9, flat({4, 4}, 1)), {9, 20, 4}), InputError);
}

TEST(Difference, CountsPixelsAndChannels) {
  const Image a = flat({10, 10}, 100);
  Image b = a;
  EXPECT_EQ(image_difference(a, b).max, 0);
  EXPECT_EQ(image_difference(a, b).differing, 0u);
  b.rgba[0] = 108;                 // within the threshold
  b.rgba[4] = 80, b.rgba[5] = 91;  // one pixel, two channels
  const ImageDifference d = image_difference(a, b);
  EXPECT_EQ(d.max, 20);
  EXPECT_EQ(d.differing, 1u);
  EXPECT_DOUBLE_EQ(d.differing_share, 0.01);
  EXPECT_DOUBLE_EQ(d.mean_absolute, (8 + 20 + 9) / 400.0);
  EXPECT_EQ(image_difference(a, b, 7).differing, 2u);
  EXPECT_THROW((void)image_difference(a, flat({10, 11}, 0)), InputError);
}

}  // namespace
}  // namespace lodestone
