// Textures at half their resolution, by the box filter on what their pixels mean.
#pragma once

#include <cstdint>
#include <vector>

#include "core/texture/image_codec.h"

namespace lodestone {

// colours: averaged as light, weighted with their alpha. normals (tangent- or object-space maps): averaged as vectors
// and made of unit length when they become bytes.
enum class PixelMeaning : std::uint8_t { colours, normals };

// Pixels as numbers that averages may be taken of, channel by channel.
struct LinearImage {
  PixelSize size;
  std::uint32_t channels = 3;
  std::vector<float> values;  // colours: light times alpha, and alpha; normals: components in [-1, 1]
};

[[nodiscard]] LinearImage to_linear(const PixelImage& image, PixelMeaning meaning);
// Rounded to the nearest byte in the encoding.
[[nodiscard]] PixelImage to_pixels(const LinearImage& image, PixelMeaning meaning);

// Half the width and height, rounded down, but at least one pixel: each pixel is the mean over its share of the image,
// which is 2 x 2 pixels where both are even, and takes in parts of pixels where one is odd.
[[nodiscard]] LinearImage halve(const LinearImage& image);
// halve(to_linear(image, meaning)), row by row: nothing as large as the image is made.
[[nodiscard]] LinearImage halve(const PixelImage& image, PixelMeaning meaning);

[[nodiscard]] constexpr PixelSize half_of(PixelSize size) {
  return {size.width > 1 ? size.width / 2 : 1, size.height > 1 ? size.height / 2 : 1};
}

}  // namespace lodestone
