#include "render/textures/mip_chain.h"

#include <utility>

#include "core/texture/texel_wrap.h"

namespace lodestone {
namespace {

// Red, green and blue: grey is all three, alpha is left out.
PixelImage three_channels(PixelImage image) {
  if (image.channels == 3) return image;
  PixelImage rgb{.size = image.size, .channels = 3, .pixels = {}};
  const std::size_t pixels = image.pixels.size() / image.channels, step = image.channels == 4 ? 1 : 0;
  rgb.pixels.resize(3 * pixels);
  for (std::size_t p = 0; p < pixels; ++p)
    for (std::size_t c = 0; c < 3; ++c) rgb.pixels[3 * p + c] = image.pixels[p * image.channels + c * step];
  return rgb;
}

MipLevel bordered(const PixelImage& image, TextureWrap wrap_u, TextureWrap wrap_v) {
  MipLevel level{image.size, {}};
  level.texels.resize(std::size_t{level.stride()} * level.rows());
  const auto [width, height] = image.size;
  std::uint32_t* to = level.texels.data();
  for (std::int64_t y = -1; y <= height; ++y) {
    const std::uint8_t* row = &image.pixels[3 * std::size_t{wrapped(y, height, wrap_v)} * width];
    const auto texel = [&](std::uint32_t x) {
      const std::uint8_t* p = row + 3 * std::size_t{x};
      return p[0] | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | 0xff00'0000u;
    };
    *to++ = texel(wrapped(-1, width, wrap_u));
    for (std::uint32_t x = 0; x < width; ++x) *to++ = texel(x);
    *to++ = texel(wrapped(width, width, wrap_u));
  }
  return level;
}

}  // namespace

std::vector<MipLevel> make_mip_chain(PixelImage image, PixelMeaning meaning, TextureWrap wrap_u, TextureWrap wrap_v) {
  image = three_channels(std::move(image));
  std::vector<MipLevel> levels;
  levels.push_back(bordered(image, wrap_u, wrap_v));
  if (image.size == PixelSize{1, 1}) return levels;
  LinearImage linear = halve(image, meaning);
  image = {};
  for (;;) {
    levels.push_back(bordered(to_pixels(linear, meaning), wrap_u, wrap_v));
    if (linear.size == PixelSize{1, 1}) break;
    linear = halve(linear);
  }
  return levels;
}

PixelImage placeholder_image() {
  PixelImage image{.size = {64, 64}, .channels = 3, .pixels = {}};
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) {
      const std::uint8_t value = (x / 8 + y / 8) % 2 == 0 ? 255 : 0;
      image.pixels.insert(image.pixels.end(), {value, 0, value});
    }
  return image;
}

}  // namespace lodestone
