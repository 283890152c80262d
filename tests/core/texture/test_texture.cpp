// Images: what is decoded, how pixels are averaged, what is refused.
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <cmath>
#include <random>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/texture/colour.h"
#include "core/texture/downsample.h"
#include "core/texture/stacked_normals.h"
#include "tests/core/texture/pixel_images.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

using test::gradient;
using test::noise;

struct Rectangle {
  double x0, x1, y0, y1;
};

// The mean of a channel over a rectangle of an image, pixel by pixel with the share of each that lies inside: the slow
// twin of the filter.
double mean_over(const std::vector<double>& values, PixelSize size, std::uint32_t channels, std::uint32_t channel,
                 const Rectangle& over) {
  const auto [x0, x1, y0, y1] = over;
  double sum = 0;
  for (std::uint32_t y = 0; y < size.height; ++y)
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const double wide = std::max(0.0, std::min(x1, x + 1.0) - std::max(x0, double(x)));
      const double high = std::max(0.0, std::min(y1, y + 1.0) - std::max(y0, double(y)));
      sum += wide * high * values[(std::size_t{y} * size.width + x) * channels + channel];
    }
  return sum / ((x1 - x0) * (y1 - y0));
}

std::vector<double> numbers_of(const PixelImage& image, PixelMeaning meaning) {
  std::vector<double> numbers;
  const std::uint32_t n = image.channels;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double unit = image.pixels[i] / 255.0;
    const double alpha = n == 4 ? image.pixels[i / 4 * 4 + 3] / 255.0 : 1;
    numbers.push_back(meaning == PixelMeaning::normals  ? 2 * unit - 1
                      : meaning == PixelMeaning::values ? unit
                      : n == 4 && i % 4 == 3            ? unit
                                                        : alpha * srgb_to_linear(unit));
  }
  return numbers;
}

// Bytes of an averaged pixel, in double.
std::vector<double> bytes_of(const std::vector<double>& pixel, PixelMeaning meaning) {
  std::vector<double> bytes;
  double square = 0;
  for (std::size_t c = 0; c < std::min<std::size_t>(pixel.size(), 3); ++c) square += pixel[c] * pixel[c];
  const double alpha = pixel.size() == 4 ? pixel[3] : 1;
  for (std::size_t c = 0; c < pixel.size(); ++c) {
    if (meaning == PixelMeaning::values) {
      bytes.push_back(255 * pixel[c]);
    } else if (meaning == PixelMeaning::normals) {
      const double scale = c < 3 && pixel.size() >= 3 && square > 0 ? 1 / std::sqrt(square) : 1;
      bytes.push_back(255 * (0.5 + 0.5 * scale * pixel[c]));
    } else {
      bytes.push_back(255 * (c == 3 ? alpha : alpha > 0 ? linear_to_srgb(pixel[c] / alpha) : 0));
    }
  }
  return bytes;
}

TEST(Downsample, IsTheMeanOverEachPixelsShare) {
  for (const PixelMeaning meaning : {PixelMeaning::colours, PixelMeaning::normals, PixelMeaning::values})
    for (const std::uint32_t channels : {1u, 3u, 4u})
      for (const PixelSize size :
           {PixelSize{8, 6}, {7, 6}, {8, 5}, {9, 11}, {1, 7}, {6, 1}, {1, 1}, {2, 2}, {3, 3}, {31, 2}}) {
        const PixelImage image = noise(size.width, size.height, channels, size.width + channels);
        const LinearImage half = halve(to_linear(image, meaning));
        const PixelImage pixels = to_pixels(half, meaning);
        const PixelSize expected{std::max(1u, size.width / 2), std::max(1u, size.height / 2)};
        ASSERT_EQ(half.size, expected);
        const std::vector<double> numbers = numbers_of(image, meaning);
        const double wide = double(size.width) / expected.width, high = double(size.height) / expected.height;
        for (std::uint32_t y = 0; y < expected.height; ++y)
          for (std::uint32_t x = 0; x < expected.width; ++x) {
            std::vector<double> pixel;
            const std::size_t at = (std::size_t{y} * expected.width + x) * channels;
            for (std::uint32_t c = 0; c < channels; ++c) {
              pixel.push_back(
                  mean_over(numbers, size, channels, c, {x * wide, (x + 1) * wide, y * high, (y + 1) * high}));
              ASSERT_NEAR(half.values[at + c], pixel[c], 2e-6);
            }
            const std::vector<double> bytes = bytes_of(pixel, meaning);
            for (std::uint32_t c = 0; c < channels; ++c) ASSERT_NEAR(pixels.pixels[at + c], bytes[c], 0.501);
          }
      }
}

// Row by row, no image of floats as large as it: the same.
TEST(Downsample, OfPixelsIsThatOfTheirNumbers) {
  for (const std::uint32_t channels : {1u, 3u, 4u})
    for (const PixelSize size : {PixelSize{1, 1}, PixelSize{2, 2}, PixelSize{7, 4}, PixelSize{6, 5}, PixelSize{1, 9}})
      for (const PixelMeaning meaning : {PixelMeaning::colours, PixelMeaning::normals, PixelMeaning::values}) {
        PixelImage image{.size = size, .channels = channels, .pixels = {}};
        for (std::size_t i = 0; i < std::size_t{size.width} * size.height * channels; ++i)
          image.pixels.push_back(static_cast<std::uint8_t>(91 * i + 5));
        const LinearImage quick = halve(image, meaning), slow = halve(to_linear(image, meaning));
        EXPECT_EQ(quick.size, slow.size);
        EXPECT_EQ(quick.values, slow.values);
      }
}

TEST(Downsample, BytesComeBack) {
  for (const PixelMeaning meaning : {PixelMeaning::colours, PixelMeaning::normals, PixelMeaning::values}) {
    PixelImage grey{.size = {256, 1}, .channels = 1, .pixels = {}};
    for (int i = 0; i < 256; ++i) grey.pixels.push_back(static_cast<std::uint8_t>(i));
    EXPECT_EQ(to_pixels(to_linear(grey, meaning), meaning), grey);
  }
  PixelImage opaque = noise(9, 9, 4);
  for (std::size_t p = 3; p < opaque.pixels.size(); p += 4) opaque.pixels[p] = 255;
  EXPECT_EQ(to_pixels(to_linear(opaque, PixelMeaning::colours), PixelMeaning::colours), opaque);
}

TEST(Downsample, WhatCannotBeSeenHasNoWeight) {
  const PixelImage image{.size = {2, 1}, .channels = 4, .pixels = {200, 100, 50, 255, 7, 255, 9, 0}};
  const PixelImage half = to_pixels(halve(to_linear(image, PixelMeaning::colours)), PixelMeaning::colours);
  EXPECT_EQ(half.pixels, (std::vector<std::uint8_t>{200, 100, 50, 128}));
}

TEST(Downsample, LightIsAveragedAndNotItsEncoding) {
  const PixelImage image{.size = {2, 2}, .channels = 1, .pixels = {0, 255, 255, 0}};
  EXPECT_EQ(to_pixels(halve(to_linear(image, PixelMeaning::colours)), PixelMeaning::colours).pixels[0], 188);
  EXPECT_EQ(to_pixels(halve(to_linear(image, PixelMeaning::normals)), PixelMeaning::normals).pixels[0], 128);
}

TEST(ImageCodec, PngKeepsEveryByte) {
  for (const std::uint32_t channels : {1u, 3u, 4u}) {
    const PixelImage image = noise(37, 19, channels);
    const std::vector<char> bytes = encode_image(image, "image/png");
    EXPECT_EQ(decode_image(bytes, "image/png"), image);
    EXPECT_EQ(image_size(bytes, "image/png"), (PixelSize{37, 19}));
    EXPECT_EQ(encode_image(image, "image/png"), bytes);
  }
}

TEST(ImageCodec, WidePngKeepsEveryBit) {
  std::mt19937 random(4);
  for (const PixelSize size : {PixelSize{1, 1}, PixelSize{37, 19}}) {
    WideImage image{size, {}};
    for (std::uint32_t i = 0; i < 3 * size.width * size.height; ++i)
      image.values.push_back(static_cast<std::uint16_t>(random()));
    const std::vector<char> bytes = encode_wide_png(image);
    EXPECT_EQ(decode_wide_png(bytes), image);
    EXPECT_EQ(std::string_view(bytes.data(), bytes.size()).find("gAMA"), std::string_view::npos);
    const PixelImage narrow = decode_image(bytes, "image/png");
    ASSERT_EQ(narrow.size, size);
    for (std::size_t i = 0; i < image.values.size(); ++i) EXPECT_NEAR(narrow.pixels[i], image.values[i] / 257.0, 0.501);
  }
}

TEST(ImageCodec, WidePngRefusesDamageAndFewerBits) {
  const WideImage image{{8, 8}, std::vector<std::uint16_t>(192, 1000)};
  std::vector<char> bytes = encode_wide_png(image);
  const auto refused = [](std::span<const char> png, const char* what) {
    expect_error_of<InputError>([&] { return decode_wide_png(png); }, {what}, what);
  };
  for (const std::size_t size : {std::size_t{0}, std::size_t{20}, std::size_t{40}, bytes.size() - 30})
    refused(std::span(bytes).first(size), "not a valid PNG");
  for (const std::uint32_t channels : {1u, 3u, 4u})
    refused(encode_image(noise(8, 8, channels), "image/png"), "16 bits");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  refused(bytes, "not a valid PNG");
}

TEST(ImageCodec, JpegKeepsWhatIsSeen) {
  for (const std::uint32_t channels : {1u, 3u}) {
    const PixelImage image = gradient(50, 41, channels);
    const std::vector<char> bytes = encode_image(image, "image/jpeg");
    const PixelImage read = decode_image(bytes, "image/jpeg");
    EXPECT_EQ(image_size(bytes, "image/jpeg"), (PixelSize{50, 41}));
    ASSERT_EQ(read.size, image.size);
    ASSERT_EQ(read.channels, channels);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) ASSERT_NEAR(read.pixels[i], image.pixels[i], 12);
    EXPECT_EQ(encode_image(image, "image/jpeg"), bytes);
  }
}

TEST(ImageCodec, WebpKeepsWhatIsSeenAndEveryByteAtQuality100) {
  for (const std::uint32_t channels : {3u, 4u}) {
    const PixelImage exact = noise(37, 19, channels);
    const std::vector<char> bytes = encode_image(exact, "image/webp", 100);
    EXPECT_EQ(decode_image(bytes, "image/webp"), exact);
    EXPECT_EQ(image_size(bytes, "image/webp"), (PixelSize{37, 19}));
    EXPECT_EQ(encode_image(exact, "image/webp", 100), bytes);
  }
  const PixelImage image = gradient(50, 41, 3);
  const std::vector<char> fine = encode_image(image, "image/webp"), coarse = encode_image(image, "image/webp", 10);
  EXPECT_LT(coarse.size(), fine.size());
  const PixelImage read = decode_image(fine, "image/webp");
  ASSERT_EQ(read.size, image.size);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) ASSERT_NEAR(read.pixels[i], image.pixels[i], 12);
  const PixelImage grey = decode_image(encode_image(noise(9, 7, 1), "image/webp", 100), "image/webp");
  EXPECT_EQ(grey.channels, 3u);
  for (std::size_t i = 0; i < 63; ++i) ASSERT_EQ(grey.pixels[3 * i + 2], noise(9, 7, 1).pixels[i]);
}

TEST(ImageCodec, ChromaIsSampledAsBefore) {
  for (const int chroma : {TJSAMP_444, TJSAMP_420}) {
    PixelImage image = gradient(64, 64, 3);
    image.chroma = chroma;
    EXPECT_EQ(decode_image(encode_image(image, "image/jpeg"), "image/jpeg").chroma, chroma);
  }
}

template <class E>
void expect_refusal(const std::vector<char>& bytes, const std::string& type, const std::string& part) {
  expect_error_of<E>([&] { return decode_image(bytes, type); }, {part});
}

TEST(ImageCodec, RefusesWhatItCannotDecode) {
  const std::vector<char> png = encode_image(noise(40, 40, 3), "image/png");
  const std::vector<char> jpeg = encode_image(gradient(40, 40, 3), "image/jpeg");
  for (const std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{40}, png.size() / 2})
    expect_refusal<InputError>({png.begin(), png.begin() + static_cast<std::ptrdiff_t>(size)}, "image/png", "PNG");
  for (const std::size_t size : {std::size_t{0}, std::size_t{10}})
    expect_refusal<InputError>({jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(size)}, "image/jpeg", "");
  expect_refusal<InputError>(png, "image/jpeg", "JPEG");
  const std::vector<char> webp = encode_image(noise(40, 40, 3), "image/webp");
  for (const std::size_t size : {std::size_t{0}, std::size_t{10}, webp.size() / 2})
    expect_refusal<InputError>({webp.begin(), webp.begin() + static_cast<std::ptrdiff_t>(size)}, "image/webp", "WebP");
  expect_refusal<InputError>(png, "image/webp", "WebP");
  expect_refusal<UnsupportedError>(png, "image/ktx2", "image/ktx2");
  EXPECT_THROW((void)image_size(png, "image/ktx2"), UnsupportedError);
  EXPECT_THROW((void)encode_image(noise(4, 4, 3), "image/ktx2"), UnsupportedError);
  EXPECT_THROW((void)encode_image(noise(20000, 1, 3), "image/webp"), UnsupportedError);
  std::vector<char> huge = png;  // width and height stand at 16; the checksum over them is then wrong, too
  huge[16] = huge[20] = 0x40;
  EXPECT_THROW((void)image_size(huge, "image/png"), Error);
}

TEST(ImageCodec, RefusesFourInks) {
  const std::vector<unsigned char> inks(16 * 16 * 4, 100);
  const tjhandle turbo = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(turbo, inks.data(), 16, 0, 16, TJPF_CMYK, &bytes, &size, TJSAMP_444, 90, 0), 0);
  expect_refusal<UnsupportedError>({bytes, bytes + size}, "image/jpeg", "CMYK");
  tjFree(bytes);
  tjDestroy(turbo);
}

Texture texture_of(const PixelImage& image, const std::string& type = "image/png") {
  return {.name = "t", .media_type = type, .bytes = encode_image(image, type)};
}

TEST(StackedNormals, AreTallAndGreyEverywhere) {
  PixelImage grey{{4, 12}, 3, std::vector<std::uint8_t>(4 * 12 * 3, 90)};
  EXPECT_TRUE(is_stacked(grey));
  for (const int off : {8, 9}) {  // WebP rounds
    PixelImage last = grey;
    last.pixels.back() = static_cast<std::uint8_t>(90 + off);
    EXPECT_EQ(is_stacked(last), off == 8);
  }
  grey.size = {12, 4};
  EXPECT_FALSE(is_stacked(grey));
}

TEST(TextureLevels, HalveDownToTheLeastSide) {
  Hierarchy h;
  h.textures = {texture_of(gradient(300, 160, 3), "image/jpeg"), texture_of(gradient(63, 4000, 3)),
                texture_of(gradient(512, 512, 1))};
  const std::vector<TextureCopy> wide = make_texture_copies(h, 0, 9);
  ASSERT_EQ(wide.size(), 2u);
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_EQ(wide[i].halvings, i + 1);
    EXPECT_EQ((PixelSize{wide[i].width, wide[i].height}), (PixelSize{300u >> (i + 1), 160u >> (i + 1)}));
    EXPECT_EQ(image_size(wide[i].bytes, "image/jpeg"), (PixelSize{wide[i].width, wide[i].height}));
  }
  EXPECT_TRUE(make_texture_copies(h, 1, 9).empty());
  EXPECT_EQ(make_texture_copies(h, 2, 9).size(), 4u);
  EXPECT_EQ(make_texture_copies(h, 2, 1).size(), 1u);
  EXPECT_TRUE(make_texture_copies(h, 2, 0).empty());
}

TEST(TextureLevels, AreHalvedFromPixelsAndNotFromCopies) {
  Hierarchy h;
  const PixelImage image = noise(256, 128, 4);
  h.textures = {texture_of(image)};
  LinearImage half = to_linear(image, PixelMeaning::colours);
  for (const TextureCopy& copy : make_texture_copies(h, 0, 2)) {
    half = halve(half);
    EXPECT_EQ(decode_image(copy.bytes, "image/png"), to_pixels(half, PixelMeaning::colours));
  }
}

TEST(TextureLevels, NormalMapsKeepUnitVectors) {
  Hierarchy h;
  h.textures = {texture_of(noise(64, 64, 3))};
  h.materials = {{.name = "m", .normal_map = 0}};
  const auto length_error = [&] {
    const PixelImage image = decode_image(make_texture_copies(h, 0, 1).at(0).bytes, "image/png");
    double worst = 0;
    for (std::size_t p = 0; p < image.pixels.size(); p += 3) {
      double square = 0;
      for (std::size_t c = 0; c < 3; ++c) square += std::pow(image.pixels[p + c] / 127.5 - 1, 2);
      worst = std::max(worst, std::abs(std::sqrt(square) - 1));
    }
    return worst;
  };
  EXPECT_LT(length_error(), 0.01);
  h.materials.push_back({.name = "also a colour", .texture = 0});
  EXPECT_GT(length_error(), 0.1);
}

TEST(TextureLevels, EachLevelShowsItsCopy) {
  Hierarchy h;
  h.levels.resize(5);  // finest: 4
  h.textures = {{.name = "a", .media_type = {}, .bytes = {'a'}}, {.name = "b", .media_type = {}, .bytes = {'b'}}};
  h.texture_copies = {{0, 1, 8, 8, {'1'}}, {0, 2, 4, 4, {'2'}}};
  const std::string shown = "2221a";
  for (int level = 0; level < 5; ++level) {
    const std::vector<Texture> textures = level_textures(h, level);
    EXPECT_EQ(textures[0].bytes, std::vector<char>{shown[static_cast<std::size_t>(level)]}) << level;
    EXPECT_EQ(textures[0].name, "a");
    EXPECT_EQ(textures[1], h.textures[1]);
  }
}

TEST(LodeAssets, CopiesComeBackInOrderOrNotAtAll) {
  Hierarchy h;
  h.textures = {{.name = "a", .media_type = {}, .bytes = {'a'}}, {.name = "b", .media_type = {}, .bytes = {'b'}}};
  h.texture_copies = {{0, 1, 8, 8, {'1'}}, {0, 2, 4, 4, {'2'}}, {1, 1, 9, 9, {}}};
  const auto fault = [](const Hierarchy& from, bool has_copies) {
    Hierarchy to;
    const char* what = decode_assets(encode_assets(from), has_copies ? lode_texture_copies : 0, to);
    if (what == nullptr) {
      EXPECT_EQ(to.texture_copies, from.texture_copies);
    }
    return std::string(what ? what : "");
  };
  EXPECT_EQ(fault(h, true), "");
  EXPECT_NE(fault(h, false), "");
  EXPECT_NE(fault(Hierarchy{}, true), "");
  using Copies = std::vector<TextureCopy>;
  const auto broken = [&](const auto& change) {
    Hierarchy other = h;
    change(other.texture_copies);
    return fault(other, true);
  };
  const std::string wrong = "the copies of textures are invalid";
  EXPECT_EQ(broken([](Copies& c) { c[2].texture = 2; }), wrong);
  EXPECT_EQ(broken([](Copies& c) { c[1].halvings = 3; }), wrong);
  EXPECT_EQ(broken([](Copies& c) { c[0].halvings = 0; }), wrong);
  EXPECT_EQ(broken([](Copies& c) { c[2].width = 0; }), wrong);
  EXPECT_EQ(broken([](Copies& c) { std::swap(c[0], c[2]); }), wrong);
}

}  // namespace
}  // namespace lodestone
