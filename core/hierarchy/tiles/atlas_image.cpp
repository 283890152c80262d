#include "core/hierarchy/tiles/atlas_image.h"

#include <cmath>
#include <string>

#include "core/texture/colour.h"
#include "core/texture/texel_wrap.h"

namespace lodestone::atlas {
namespace {

// The pixel at (x, y), texel centres being at halves; interpolated where the image has another resolution.
std::array<float, 4> pixel_at(const PixelImage& image, const Use& use, double x, double y) {
  const double column = x * image.size.width / use.size.width - 0.5,
               row = y * image.size.height / use.size.height - 0.5;
  const double left = std::floor(column), top = std::floor(row), across = column - left, down = row - top;
  std::array<float, 4> sum{0, 0, 0, 0};
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const double weight = (i ? across : 1 - across) * (j ? down : 1 - down);
      if (weight == 0) continue;
      const std::size_t at =
          std::size_t{wrapped(static_cast<std::int64_t>(top) + j, image.size.height, use.wrap_v)} * image.size.width +
          wrapped(static_cast<std::int64_t>(left) + i, image.size.width, use.wrap_u);
      const std::uint8_t* p = &image.pixels[at * image.channels];
      for (std::size_t c = 0; c < 4; ++c) {
        const float value = c == 3 ? (image.channels == 4 ? p[3] : 255.0f) : p[image.channels == 1 ? 0 : c];
        sum[c] += static_cast<float>(weight) * value;
      }
    }
  return sum;
}

// A byte of a colour times a factor of its light.
float times(float byte, float factor, bool is_alpha) {
  if (factor == 1) return byte;
  if (is_alpha) return byte * factor;
  return static_cast<float>(std::clamp(255 * linear_to_srgb(srgb_to_linear(double{byte} / 255) * factor), 0.0, 255.0));
}

// Colours are multiplied by the factor.
void paint(const Use& use, std::size_t part, std::size_t map, const std::array<float, 4>& factor, PixelImage& image,
           std::vector<bool>& painted) {
  const TexelBox& box = use.parts[part];
  const PagePlace& at = use.places[part];
  const std::uint32_t width = padded(box.width()), height = padded(box.height());
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const double u = static_cast<double>(box.x0) - gutter + x + 0.5,
                   v = static_cast<double>(box.y0) - gutter + y + 0.5;
      std::array<float, 4> value{255, 255, 255, 255};
      if (use.maps[map]) value = pixel_at(*use.maps[map], use, u, v);
      for (std::size_t c = 0; c < 4; ++c) value[c] = times(value[c], factor[c], c == 3);
      const std::size_t pixel = std::size_t{at.y + y} * image.size.width + at.x + x;
      painted[pixel] = true;
      for (std::size_t c = 0; c < image.channels; ++c)
        image.pixels[pixel * image.channels + c] = static_cast<std::uint8_t>(std::lround(value[c]));
    }
}

// The mean colour where no part is: small mip levels show a little of it.
void fill_rest(const std::vector<bool>& painted, PixelImage& image) {
  std::array<std::uint64_t, 4> sum{};
  std::uint64_t count = 0;
  for (std::size_t p = 0; p < painted.size(); ++p) {
    if (!painted[p]) continue;
    ++count;
    for (std::size_t c = 0; c < image.channels; ++c) sum[c] += image.pixels[p * image.channels + c];
  }
  for (std::size_t p = 0; p < painted.size(); ++p)
    for (std::size_t c = 0; !painted[p] && c < image.channels; ++c)
      image.pixels[p * image.channels + c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
}

// That of the sources if they agree; else one that loses nothing that any of them has.
std::string media_type_for(const Hierarchy& hierarchy, std::span<Use* const> uses, std::size_t map, bool alpha) {
  std::string type;
  for (const Use* use : uses) {
    const std::uint32_t texture = maps_of(hierarchy.materials[use->material])[map];
    if (texture == no_texture) continue;
    const std::string& own = hierarchy.textures[texture].media_type;
    if (!type.empty() && type != own) return "image/png";
    type = own;
  }
  return type.empty() || (alpha && type == "image/jpeg") ? "image/png" : type;
}

}  // namespace

Texture encode(const Hierarchy& hierarchy, std::span<Use* const> uses, std::size_t map, PixelSize size,
               bool bakes_colour) {
  const Material& first = hierarchy.materials[uses.front()->material];
  const bool alpha = map == colours && first.alpha_mode != AlphaMode::opaque;
  PixelImage image{.size = size, .channels = alpha ? 4u : 3u, .pixels = {}};
  image.pixels.assign(std::size_t{size.width} * size.height * image.channels, 0);
  std::vector<bool> painted(std::size_t{size.width} * size.height);
  for (const Use* use : uses) {
    std::array<float, 4> factor{1, 1, 1, 1};
    if (bakes_colour && map == colours) factor = hierarchy.materials[use->material].base_colour;
    for (std::size_t part = 0; part < use->parts.size(); ++part) paint(*use, part, map, factor, image, painted);
  }
  fill_rest(painted, image);
  Texture texture;
  texture.media_type = media_type_for(hierarchy, uses, map, alpha);
  texture.wrap_u = texture.wrap_v = TextureWrap::clamp;
  texture.bytes = encode_image(image, texture.media_type);
  return texture;
}

}  // namespace lodestone::atlas
