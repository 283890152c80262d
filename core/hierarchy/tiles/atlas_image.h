// The image of an atlas: the parts of textures, painted at their places (atlas_parts.h).
#pragma once

#include <span>

#include "core/hierarchy/tiles/atlas_parts.h"

namespace lodestone::atlas {

// One kind of map of all uses, which have been packed. bakes_colour: base colours are multiplied into the colours.
// Throws ResourceError when it cannot be encoded.
[[nodiscard]] Texture encode(const Hierarchy& hierarchy, std::span<Use* const> uses, std::size_t map, PixelSize size,
                             bool bakes_colour);

}  // namespace lodestone::atlas
