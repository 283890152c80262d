// Textures at half their resolution, by the box filter on light or vectors, not on encoded bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "core/texture/image_codec.h"

namespace lodestone {

// colours: averaged as light, weighted with their alpha. normals (tangent- or object-space maps): averaged as vectors
// and normalised when they become bytes. values (roughness, occlusion): each channel averaged for itself.
enum class PixelMeaning : std::uint8_t { colours, normals, values };

// Pixels as numbers that can be averaged, channel by channel.
struct LinearImage {
  PixelSize size;
  std::uint32_t channels = 3;
  std::vector<float> values;  // colours: light times alpha, and alpha; normals: components in [-1, 1]; values: in [0, 1]
};

[[nodiscard]] LinearImage to_linear(const PixelImage& image, PixelMeaning meaning);
// The inverse, rounded to the nearest byte in the encoding.
[[nodiscard]] PixelImage to_pixels(const LinearImage& image, PixelMeaning meaning);

// Half the width and height, rounded down, but at least one pixel: each pixel is the mean over its share of the image,
// which is 2 x 2 pixels if both sizes are even, and includes parts of pixels if one is odd.
[[nodiscard]] LinearImage halve(const LinearImage& image);
// halve(to_linear(image, meaning)), row by row, without a copy as large as the image.
[[nodiscard]] LinearImage halve(const PixelImage& image, PixelMeaning meaning);

[[nodiscard]] constexpr PixelSize half_of(PixelSize size) {
  return {size.width > 1 ? size.width / 2 : 1, size.height > 1 ? size.height / 2 : 1};
}

}  // namespace lodestone
