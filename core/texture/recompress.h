// Textures encoded again, smaller.
#pragma once

#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone {

// The texture at a quality from 1 to 100 (image_codec.h), of the same size in pixels; as it is where that is not
// smaller or where this program does not decode it. Colours become WebP, with their alpha as it is. WebP halves the
// resolution of colours, which in data may blur one channel by another: normals become WebP where its error is at most
// twice that of JPEG of full resolution, and that otherwise; data of several channels become such JPEG, or WebP without
// loss where they have alpha; data of one channel become WebP. Normals have no alpha.
[[nodiscard]] Texture recompressed(const Texture& texture, PixelMeaning meaning, int quality);

}  // namespace lodestone
