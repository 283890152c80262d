// Textures encoded again: smaller, of the same size in pixels, and no channel of data blurred by another.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/texture/recompress.h"
#include "tests/core/texture/pixel_images.h"

namespace lodestone {
namespace {

using test::gradient;
using test::noise;

TEST(Recompressed, IsASmallerWebpOfTheSameSizeOrTheTextureItself) {
  PixelImage picture = gradient(90, 70, 4);
  const PixelImage grain = noise(90, 70, 4);
  for (std::size_t k = 0; k < grain.pixels.size(); ++k)
    picture.pixels[k] = static_cast<std::uint8_t>(picture.pixels[k] / 2 + grain.pixels[k] % 8);
  const Texture png{.name = "a",
                    .media_type = "image/png",
                    .wrap_u = TextureWrap::mirror,
                    .bytes = encode_image(picture, "image/png")};
  const Texture webp = recompressed(png, PixelMeaning::colours, 80);
  EXPECT_EQ(webp.media_type, "image/webp");
  EXPECT_EQ(webp.name, png.name);
  EXPECT_EQ(webp.wrap_u, png.wrap_u);
  EXPECT_LT(webp.bytes.size(), png.bytes.size());
  const PixelImage image = decode_image(webp.bytes, "image/webp"), before = decode_image(png.bytes, "image/png");
  EXPECT_EQ(image.size, before.size);
  double sum = 0;
  for (std::size_t k = 0; k < image.pixels.size() / image.channels; ++k)
    for (std::size_t c = 0; c < 3; ++c)
      sum += std::abs(int{image.pixels[k * image.channels + c]} - int{before.pixels[k * before.channels + c]});
  EXPECT_LT(sum, 4.0 * 3 * 90 * 70);
  EXPECT_EQ(recompressed(webp, PixelMeaning::colours, 100), webp);  // without loss is not smaller
  const Texture foreign{.name = "b", .media_type = "image/ktx2", .bytes = {'k', 't', 'x'}};
  EXPECT_EQ(recompressed(foreign, PixelMeaning::colours, 50), foreign);
  const Texture damaged{.name = "c", .media_type = "image/png", .bytes = {'p', 'n', 'g'}};
  EXPECT_EQ(recompressed(damaged, PixelMeaning::colours, 50), damaged);
}

// Stripes of a texel in one channel alone: half the resolution of colours would make grey of them.
PixelImage striped(std::uint32_t channels) {
  PixelImage image{.size = {64, 64}, .channels = channels, .pixels = {}};
  for (std::uint32_t k = 0; k < 64 * 64; ++k)
    for (std::uint32_t c = 0; c < channels; ++c)
      image.pixels.push_back(static_cast<std::uint8_t>(c == 0 ? 128 : c == 1 ? 60 + 100 * (k % 2) : c == 2 ? 200 : k));
  return image;
}

int largest_change(const PixelImage& before, const Texture& after) {
  const PixelImage image = decode_image(after.bytes, after.media_type);
  int largest = 0;
  for (std::size_t k = 0; k < before.pixels.size() / before.channels; ++k)
    for (std::size_t c = 0; c < before.channels; ++c)
      largest = std::max(largest, std::abs(int{image.pixels[k * image.channels + (c < image.channels ? c : 0)]} -
                                           before.pixels[k * before.channels + c]));
  return largest;
}

TEST(Recompressed, DataKeepsItsChannelsApart) {
  const PixelImage picture = striped(3);
  Texture png{.name = "a", .media_type = "image/png", .bytes = encode_image(picture, "image/png")};
  png.bytes.resize(20'000);  // what follows the end of an image counts as little as how well it is packed
  EXPECT_GT(largest_change(picture, recompressed(png, PixelMeaning::colours, 90)), 25);
  for (const PixelMeaning meaning : {PixelMeaning::values, PixelMeaning::normals}) {
    const Texture data = recompressed(png, meaning, 90);
    EXPECT_EQ(data.media_type, "image/jpeg");
    EXPECT_LT(largest_change(picture, data), 12);
  }
}

// A surface's normals: their channels change together.
TEST(Recompressed, NormalsOfAReliefBecomeWebp) {
  PixelImage picture{.size = {64, 64}, .channels = 3, .pixels = {}};
  for (int k = 0; k < 64 * 64; ++k) {
    const double x = 0.5 * std::sin(0.3 * (k % 64)), y = 0.5 * std::cos(0.2 * (k / 64));
    for (const double v : {x, y, std::sqrt(1 - x * x - y * y)})
      picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * v)));
  }
  const Texture png{.name = "a", .media_type = "image/png", .bytes = encode_image(picture, "image/png")};
  const Texture data = recompressed(png, PixelMeaning::normals, 80);
  EXPECT_EQ(data.media_type, "image/webp");
  EXPECT_LT(largest_change(picture, data), 24);
}

TEST(Recompressed, AlphaIsAsItWas) {
  const PixelImage picture = striped(4);
  Texture png{.name = "a", .media_type = "image/png", .bytes = encode_image(picture, "image/png")};
  png.bytes.resize(40'000);
  EXPECT_EQ(largest_change(picture, recompressed(png, PixelMeaning::values, 50)), 0);
  const Texture normals = recompressed(png, PixelMeaning::normals, 50);  // of three coordinates
  EXPECT_EQ(normals.media_type, "image/jpeg");
  const Texture colours = recompressed(png, PixelMeaning::colours, 50);
  const PixelImage image = decode_image(colours.bytes, colours.media_type);
  ASSERT_EQ(image.channels, 4u);
  for (std::size_t k = 3; k < image.pixels.size(); k += 4) ASSERT_EQ(image.pixels[k], picture.pixels[k]);
}

TEST(Recompressed, OneChannelIsWebpWithoutColour) {
  PixelImage picture = gradient(64, 64, 3);
  for (std::size_t k = 0; k < picture.pixels.size(); k += 3)
    picture.pixels[k + 1] = picture.pixels[k + 2] = picture.pixels[k];
  Texture png{.name = "a", .media_type = "image/png", .bytes = encode_image(picture, "image/png")};
  png.bytes.resize(20'000);
  const Texture data = recompressed(png, PixelMeaning::values, 80);
  EXPECT_EQ(data.media_type, "image/webp");
  EXPECT_LT(largest_change(picture, data), 8);
}

}  // namespace
}  // namespace lodestone
