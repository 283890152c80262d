// Small copies of the textures of a progressive mesh: its files hold them before its splits, so that the base is drawn
// with its textures while the images themselves are still on the way.
#pragma once

#include <vector>

#include "core/base/runner.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

// For each texture that a material draws: its thumbnail (core/texture/thumbnail.h). Without bytes for any other
// texture, and for one that this program does not decode.
[[nodiscard]] std::vector<Texture> make_thumbnails(const ProgressiveMesh& mesh, const Runner& runner = {});

}  // namespace lodestone
