// The meanings of the textures of a progressive mesh.
#pragma once

#include <optional>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"
#include "core/texture/downsample.h"

namespace lodestone {

// By texture: its meaning to the materials; nothing for one that no material names, or that is not drawn where levels
// change. Colours come first where a texture has several.
[[nodiscard]] std::vector<std::optional<PixelMeaning>> texture_meanings(const ProgressiveMesh& mesh);

}  // namespace lodestone
