// Normals as three square grey images below one another: x, y and z. WebP halves the resolution of colours, which would
// blur them.
#pragma once

#include "core/texture/image_codec.h"

namespace lodestone {

// The image is square and has 3 channels.
[[nodiscard]] PixelImage stacked(const PixelImage& image);
// True if the image is three times as high as wide, and without colour.
[[nodiscard]] bool is_stacked(const PixelImage& image);
// The inverse of stacked(); the image may have got equal channels on the way.
[[nodiscard]] PixelImage unstacked(const PixelImage& planes);

}  // namespace lodestone
