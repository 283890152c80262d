// Textures encoded again, smaller.
#pragma once

#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone {

// The texture at a quality from 1 to 100 (image_codec.h), of the same size in pixels; as it is where that is not
// smaller or where this program does not decode it. Colours become WebP, with their alpha as it is. WebP halves the
// resolution of colours, which in data would blur one channel by another: data of several channels become JPEG of full
// resolution, or WebP without loss where they have alpha; data of one channel become WebP. Normals have no alpha, and
// lose half as much as the quality says: light shows their errors enlarged.
[[nodiscard]] Texture recompressed(const Texture& texture, PixelMeaning meaning, int quality);

}  // namespace lodestone
