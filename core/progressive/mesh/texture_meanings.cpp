#include "core/progressive/mesh/texture_meanings.h"

#include <cstddef>
#include <cstdint>

namespace lodestone {

std::vector<std::optional<PixelMeaning>> texture_meanings(const ProgressiveMesh& mesh) {
  std::vector<std::optional<PixelMeaning>> out(mesh.wedges.textures.size());
  const auto mark = [&](std::uint32_t texture, PixelMeaning meaning) {
    if (texture < out.size()) out[texture] = meaning;
  };
  const std::vector<Material>& materials = mesh.wedges.materials;
  for (const Material& m : materials) {
    for (const PlacedTexture& carried : {m.metallic_roughness, m.occlusion})
      mark(carried.texture, PixelMeaning::values);
    for (const std::uint32_t texture : m.extension_textures) mark(texture, PixelMeaning::values);
  }
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const std::uint32_t object = m < mesh.object_normals.size() ? mesh.object_normals[m] : no_texture;
    mark(object != no_texture ? object : materials[m].normal_map, PixelMeaning::normals);
    mark(materials[m].emissive_map.texture, PixelMeaning::colours);
    mark(materials[m].texture, PixelMeaning::colours);
  }
  return out;
}

}  // namespace lodestone
