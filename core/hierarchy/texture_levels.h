// Which copy of a texture a level shows: the finest level the texture itself, each coarser one a copy of half the
// width and height of the one before, as far as there are copies.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/hierarchy/hierarchy.h"

namespace lodestone {

// nullptr: the texture itself.
[[nodiscard]] const TextureCopy* texture_copy(const Hierarchy& hierarchy, std::uint32_t texture, int level);

// The textures as this level shows them.
[[nodiscard]] std::vector<Texture> level_textures(const Hierarchy& hierarchy, int level);

}  // namespace lodestone
