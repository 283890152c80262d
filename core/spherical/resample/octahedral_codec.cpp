#include "core/spherical/resample/octahedral_codec.h"

#include <algorithm>

#include "core/math/vec3.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/octahedron/square_atlas.h"
#include "core/texture/stacked_normals.h"

namespace lodestone::spherical {
namespace {

std::uint16_t code(float v) { return static_cast<std::uint16_t>((std::clamp(v, -1.0f, 1.0f) + 1) * 32767.5f + 0.5f); }
float decoded(std::uint16_t v) { return static_cast<float>(v) / 32767.5f - 1; }

Vec3f unit(Vec3f n) {
  const float size = length(n);
  return size > 0 ? (1 / size) * n : Vec3f{0, 0, 1};
}

bool has_wide_codes(PixelMeaning meaning, const std::string& media_type) {
  return meaning == PixelMeaning::normals && media_type == "image/png";
}

bool is_opaque(const PixelImage& image) {
  for (std::size_t i = 3; i < image.pixels.size(); i += 4)
    if (image.pixels[i] != 255) return false;
  return image.channels == 4;
}

void drop_alpha(PixelImage& image) {
  for (std::size_t p = 0; 4 * p < image.pixels.size(); ++p)
    std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(4 * p), 3,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * p));
  image.pixels.resize(image.pixels.size() / 4 * 3);
  image.channels = 3;
}

constexpr std::uint32_t webp_side = 16383;  // at most

}  // namespace

WideImage wide_normals(const LinearImage& normals) {
  WideImage image{normals.size, {}};
  image.values.reserve(normals.values.size());
  for (std::size_t p = 0; p < normals.values.size(); p += 3) {
    const Vec3f n = unit({normals.values[p], normals.values[p + 1], normals.values[p + 2]});
    image.values.insert(image.values.end(), {code(n.x), code(n.y), code(n.z)});
  }
  return image;
}

LinearImage normals_of(const WideImage& image) {
  LinearImage normals{image.size, 3, {}};
  normals.values.reserve(image.values.size());
  for (std::size_t p = 0; p < image.values.size(); p += 3) {
    const Vec3f n = unit({decoded(image.values[p]), decoded(image.values[p + 1]), decoded(image.values[p + 2])});
    normals.values.insert(normals.values.end(), {n.x, n.y, n.z});
  }
  return normals;
}

std::vector<char> encode_octahedral(const LinearImage& image, PixelMeaning meaning, const std::string& media_type,
                                    int quality) {
  if (has_wide_codes(meaning, media_type)) return encode_wide_png(wide_normals(image));
  PixelImage pixels = to_pixels(image, meaning);
  if (meaning == PixelMeaning::colours && is_opaque(pixels)) drop_alpha(pixels);
  const bool stack = meaning == PixelMeaning::normals && media_type == "image/webp" && quality < 100 &&
                     3 * pixels.size.height <= webp_side;
  if (stack) return encode_image(stacked(pixels), media_type, std::max(13 * quality / 20, 1));
  return encode_image(pixels, media_type, quality);
}

LinearImage decode_octahedral(std::span<const char> bytes, PixelMeaning meaning, const std::string& media_type,
                              const OctahedralLayout& layout) {
  if (has_wide_codes(meaning, media_type)) return normals_of(decode_wide_png(bytes));
  PixelImage pixels = decode_image(bytes, media_type);
  if (meaning == PixelMeaning::normals && is_stacked(pixels)) pixels = unstacked(pixels);
  if (layout.squares.empty()) {
    copy_border(std::span(pixels.pixels), pixels.size.width, pixels.channels);
  } else {
    continue_squares(std::span(pixels.pixels), pixels.size.width, pixels.channels, layout);
  }
  return to_linear(pixels, meaning);
}

}  // namespace lodestone::spherical
