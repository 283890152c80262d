// Which copy of a texture a level shows: the finest level the texture itself, each coarser one a copy of half the
// width and height of the one before, as far as there are copies.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// No side of a copy is shorter: what is left then is hardly smaller than its headers.
inline constexpr std::uint32_t least_texture_side = 32;

// Copies of one texture for `most` coarser levels, as far as least_texture_side lets; by halve() of
// core/texture/downsample.h, each from the one before (before it was encoded), as colours, or as normals when materials
// know it as a normal map only. Throws what decode_image and encode_image throw.
[[nodiscard]] std::vector<TextureCopy> make_texture_copies(const Hierarchy& hierarchy, std::uint32_t texture, int most);

// nullptr: the texture itself.
[[nodiscard]] const TextureCopy* texture_copy(const Hierarchy& hierarchy, std::uint32_t texture, int level);

// The textures as this level shows them.
[[nodiscard]] std::vector<Texture> level_textures(const Hierarchy& hierarchy, int level);

}  // namespace lodestone
