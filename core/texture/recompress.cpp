#include "core/texture/recompress.h"

#include <cstddef>
#include <utility>

#include "core/base/error.h"
#include "core/texture/image_codec.h"

namespace lodestone {
namespace {

// The first channels of every pixel.
void keep_channels(PixelImage& image, std::uint32_t channels) {
  const std::size_t count = image.pixels.size() / image.channels;
  for (std::size_t p = 0; p < count; ++p)
    for (std::size_t c = 0; c < channels; ++c) image.pixels[p * channels + c] = image.pixels[p * image.channels + c];
  image.pixels.resize(count * channels);
  image.channels = channels;
}

bool is_opaque(const PixelImage& image) {
  for (std::size_t p = 3; p < image.pixels.size(); p += 4)
    if (image.pixels[p] != 255) return false;
  return true;
}

bool is_grey(const PixelImage& image) {
  for (std::size_t p = 0; p < image.pixels.size(); p += image.channels)
    if (image.pixels[p] != image.pixels[p + 1] || image.pixels[p] != image.pixels[p + 2]) return false;
  return true;
}

// WebP halves the resolution of colours: of normals it is the better one where their channels change together.
std::vector<char> encode_normals(const PixelImage& image, int quality, std::string& type) {
  std::vector<char> jpeg = encode_image(image, "image/jpeg", quality), webp = encode_image(image, type, quality);
  const auto error = [&](const std::vector<char>& bytes, const std::string& media_type) {
    return squared_error(image, decode_image(bytes, media_type));
  };
  constexpr std::uint64_t most_loss = 4;  // of squares: twice the error
  if (error(webp, type) <= most_loss * error(jpeg, "image/jpeg")) return webp;
  type = "image/jpeg";
  return jpeg;
}

std::vector<char> encode(PixelImage image, PixelMeaning meaning, int quality, std::string& type) {
  const bool normals = meaning == PixelMeaning::normals;
  if (image.channels == 4 && (normals || is_opaque(image))) keep_channels(image, 3);
  type = "image/webp";
  if (meaning != PixelMeaning::colours) {
    if (image.channels == 4) return encode_image(image, type, 100);
    if (normals) return encode_normals(image, quality, type);
    if (image.channels == 3 && !is_grey(image)) type = "image/jpeg";
  }
  return encode_image(image, type, quality);
}

}  // namespace

Texture recompressed(const Texture& texture, PixelMeaning meaning, int quality) {
  Texture out = texture;
  try {
    out.bytes = encode(decode_image(texture.bytes, texture.media_type), meaning, quality, out.media_type);
  } catch (const InputError&) {
    return texture;
  } catch (const UnsupportedError&) {
    return texture;
  }
  return out.bytes.size() < texture.bytes.size() ? out : texture;
}

}  // namespace lodestone
