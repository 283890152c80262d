#include "core/texture/recompress.h"

#include "core/base/error.h"
#include "core/texture/image_codec.h"

namespace lodestone {

Texture recompressed(const Texture& texture, int quality) {
  Texture out = texture;
  out.media_type = "image/webp";
  try {
    out.bytes = encode_image(decode_image(texture.bytes, texture.media_type), out.media_type, quality);
  } catch (const InputError&) {
    return texture;
  } catch (const UnsupportedError&) {
    return texture;
  }
  return out.bytes.size() < texture.bytes.size() ? out : texture;
}

}  // namespace lodestone
