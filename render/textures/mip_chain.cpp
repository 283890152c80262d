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

// Alpha as an image of its own.
PixelImage alpha_of(const PixelImage& image) {
  PixelImage alpha{.size = image.size, .channels = 1, .pixels = {}};
  for (std::size_t p = 3; p < image.pixels.size(); p += 4) alpha.pixels.push_back(image.pixels[p]);
  return alpha;
}

// The texel of each pixel, with the border around them.
template <class TexelAt>
MipLevel bordered(PixelSize size, TextureWrap wrap_u, TextureWrap wrap_v, const TexelAt& texel_at) {
  MipLevel level{size, {}};
  level.texels.resize(std::size_t{level.stride()} * level.rows());
  const auto [width, height] = size;
  std::uint32_t* to = level.texels.data();
  for (std::int64_t y = -1; y <= height; ++y) {
    const std::size_t row = std::size_t{wrapped(y, height, wrap_v)} * width;
    *to++ = texel_at(row + wrapped(-1, width, wrap_u));
    for (std::uint32_t x = 0; x < width; ++x) *to++ = texel_at(row + x);
    *to++ = texel_at(row + wrapped(width, width, wrap_u));
  }
  return level;
}

MipLevel bordered(const PixelImage& image, TextureWrap wrap_u, TextureWrap wrap_v) {
  return bordered(image.size, wrap_u, wrap_v, [&](std::size_t pixel) {
    const std::uint8_t* p = &image.pixels[3 * pixel];
    return p[0] | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | 0xff00'0000u;
  });
}

// Calls visit(image) for the image and all its halves.
template <class Visit>
void for_each_level(PixelImage image, PixelMeaning meaning, const Visit& visit) {
  visit(image);
  if (image.size == PixelSize{1, 1}) return;
  LinearImage linear = halve(image, meaning);
  image = {};
  for (;;) {
    visit(to_pixels(linear, meaning));
    if (linear.size == PixelSize{1, 1}) return;
    linear = halve(linear);
  }
}

}  // namespace

std::vector<MipLevel> make_mip_chain(PixelImage image, PixelMeaning meaning, TextureWrap wrap_u, TextureWrap wrap_v,
                                     TexelAlpha alpha) {
  PixelImage own_alpha;
  if (alpha == TexelAlpha::kept && image.channels == 4) own_alpha = alpha_of(image);
  std::vector<MipLevel> levels;
  for_each_level(three_channels(std::move(image)), meaning,
                 [&](const PixelImage& level) { levels.push_back(bordered(level, wrap_u, wrap_v)); });
  if (own_alpha.pixels.empty()) return levels;
  std::size_t next = 0;
  for_each_level(std::move(own_alpha), PixelMeaning::values, [&](const PixelImage& level) {
    const MipLevel values = bordered(
        level.size, wrap_u, wrap_v, [&](std::size_t p) { return std::uint32_t{level.pixels[p]} << 24 | 0x00ff'ffffu; });
    std::vector<std::uint32_t>& texels = levels[next++].texels;
    for (std::size_t k = 0; k < texels.size(); ++k) texels[k] &= values.texels[k];
  });
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
