#include "core/texture/thumbnail.h"

#include <algorithm>
#include <utility>

#include "core/texture/image_codec.h"
#include "core/texture/stacked_normals.h"

namespace lodestone {
namespace {

bool is_small(PixelSize size) { return std::max(size.width, size.height) <= thumbnail_side; }

}  // namespace

Texture thumbnail_of(const Texture& texture, PixelMeaning meaning) {
  PixelImage image = decode_image(texture.bytes, texture.media_type);
  if (meaning == PixelMeaning::normals && is_stacked(image)) image = unstacked(image);
  if (is_small(image.size)) return texture;
  LinearImage half = halve(image, meaning);
  while (!is_small(half.size)) half = halve(half);
  Texture out = texture;
  out.media_type = "image/webp";
  out.bytes = encode_image(to_pixels(half, meaning), out.media_type, thumbnail_quality);
  return out.bytes.size() < texture.bytes.size() ? std::move(out) : texture;
}

}  // namespace lodestone
