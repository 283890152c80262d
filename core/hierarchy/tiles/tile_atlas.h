// Few images for a tile of many materials: the parts of their textures that the tile shows, side by side.
//
// Materials that differ in nothing but their textures and base colour become one material with an *atlas* for each kind
// of map. The parts are rectangles around charts, triangles that are connected and have one material, with a gutter
// that continues the texture as it does itself, repeated or mirrored: mip levels mix no parts down to 1/8 of the
// resolution. Base colours that differ are multiplied into the pixels.
//
// Left as they are: materials whose charts cover more than two repetitions of a texture; that place maps by transforms
// of their own (KHR_texture_transform); with textures that cannot be decoded or that belong to extensions.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/texture/image_codec.h"

namespace lodestone {

struct TileAtlasConfig {
  // Pixels of a texture as the tile's level shows it; null: it cannot be decoded. Called from any thread.
  std::function<std::shared_ptr<const PixelImage>(std::uint32_t texture)> pixels;
  std::uint32_t most_materials = 4;   // a tile of no more is left as it is
  std::uint32_t longest_side = 4096;  // of an atlas, texels
  bool morph = false;                 // the tile also shows its vertices at their parents' coordinates
};

struct TileAtlas {
  std::vector<Texture> images;      // encoded
  std::vector<Material> materials;  // their textures are numbers of images
  // By material of the hierarchy: the one of `materials` that replaces it, or no_material.
  std::vector<std::uint32_t> replaced_by;
  std::vector<Vec2f> uv;         // by vertex of the cell
  std::vector<Vec2f> parent_uv;  // likewise, of its parent's coordinates; empty unless the tile morphs
  std::uint32_t repeating = 0;   // materials left as they are because their textures repeat too often

  [[nodiscard]] std::optional<std::uint32_t> replacing(std::uint32_t material) const {
    if (material >= replaced_by.size() || replaced_by[material] == no_material) return std::nullopt;
    return replaced_by[material];
  }
};

// Empty where there is nothing to gain. Throws ResourceError when an image cannot be encoded.
[[nodiscard]] TileAtlas make_tile_atlas(const Hierarchy& hierarchy, CellId cell, const TileAtlasConfig& config);

}  // namespace lodestone
