// Tells the space of a normal map.
#pragma once

#include "core/texture/image_codec.h"

namespace lodestone {

// Formats do not specify the space, but texels reveal it: normals of a tangent-space map
// point out of the surface, blue at least 128, those of an object-space map of a solid object in all directions. True
// if more than a sixteenth of the texels that are unit vectors point inwards.
[[nodiscard]] bool is_object_space(const PixelImage& normal_map);

}  // namespace lodestone
