// Images that the tests of core/texture share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

#include "core/texture/image_codec.h"

namespace lodestone::test {

inline PixelImage noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels, unsigned seed = 1) {
  PixelImage image{.size = {width, height}, .channels = channels, .pixels = {}};
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < std::size_t{width} * height * channels; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(random() % 256));
  return image;
}

// Smooth, so that lossy compression keeps it.
inline PixelImage gradient(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  PixelImage image{.size = {width, height}, .channels = channels, .pixels = {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (std::uint32_t c = 0; c < channels; ++c)
        image.pixels.push_back(static_cast<std::uint8_t>(c == 0   ? 255 * x / width
                                                         : c == 1 ? 255 * y / height
                                                                  : 128 + 100 * x / width));
  return image;
}

}  // namespace lodestone::test
