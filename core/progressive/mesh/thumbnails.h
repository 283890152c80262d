// Small copies of the textures of a progressive mesh: its files hold them before its splits, so that the base is drawn
// with its textures while the images themselves are still on the way.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

inline constexpr std::uint32_t thumbnail_side = 64;  // texels at most
inline constexpr int thumbnail_quality = 75;

// For each texture that a material draws: a WebP of at most thumbnail_side texels a side, halved as its mip levels are,
// some hundred bytes to 2 kB; the texture itself if it is not larger. Without bytes for any other texture, and for one
// that this program does not decode.
[[nodiscard]] std::vector<Texture> make_thumbnails(const ProgressiveMesh& mesh);

}  // namespace lodestone
