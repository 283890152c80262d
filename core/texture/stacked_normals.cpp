#include "core/texture/stacked_normals.h"

#include <cstdlib>

namespace lodestone {

PixelImage stacked(const PixelImage& image) {
  PixelImage planes{.size = {image.size.width, 3 * image.size.height}, .channels = 1, .pixels = {}};
  planes.pixels.reserve(image.pixels.size());
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = k; i < image.pixels.size(); i += 3) planes.pixels.push_back(image.pixels[i]);
  return planes;
}

bool is_stacked(const PixelImage& image) {
  constexpr int rounding = 8;  // of the way through WebP's colours
  if (image.size.height != 3 * image.size.width) return false;
  for (std::size_t i = 0; image.channels >= 3 && i < image.pixels.size(); i += image.channels)
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}})
      if (std::abs(int{image.pixels[i]} - int{image.pixels[i + k]}) > rounding) return false;
  return true;
}

PixelImage unstacked(const PixelImage& planes) {
  PixelImage image{.size = {planes.size.width, planes.size.width}, .channels = 3, .pixels = {}};
  const std::size_t count = std::size_t{planes.size.width} * planes.size.width;
  image.pixels.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) image.pixels.push_back(planes.pixels[(k * count + i) * planes.channels]);
  return image;
}

}  // namespace lodestone
