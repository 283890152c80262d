// Small copies of textures, which viewers draw while the textures are still on their way.
#pragma once

#include <cstdint>

#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone {

inline constexpr std::uint32_t thumbnail_side = 64;  // texels at most
inline constexpr int thumbnail_quality = 75;

// A WebP of at most thumbnail_side texels a side, halved as mip levels are, some hundred bytes to 2 kB; the texture
// itself if it is not larger. Throws as decode_image does.
[[nodiscard]] Texture thumbnail_of(const Texture& texture, PixelMeaning meaning);

}  // namespace lodestone
