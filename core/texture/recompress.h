// Textures encoded again, smaller.
#pragma once

#include "core/mesh/attributes.h"

namespace lodestone {

// The texture as a WebP of a quality from 1 to 100 (image_codec.h), of the same size in pixels; as it is where that is
// not smaller or where this program does not decode it.
[[nodiscard]] Texture recompressed(const Texture& texture, int quality);

}  // namespace lodestone
