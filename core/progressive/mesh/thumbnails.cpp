#include "core/progressive/mesh/thumbnails.h"

#include <optional>

#include "core/base/error.h"
#include "core/texture/thumbnail.h"

namespace lodestone {
namespace {

// The meaning of each texture to the materials; empty for one that is not drawn where levels change.
std::vector<std::optional<PixelMeaning>> meanings_of(const ProgressiveMesh& mesh) {
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

}  // namespace

std::vector<Texture> make_thumbnails(const ProgressiveMesh& mesh) {
  const std::vector<std::optional<PixelMeaning>> meanings = meanings_of(mesh);
  std::vector<Texture> out(mesh.wedges.textures.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!meanings[k]) continue;
    try {
      out[k] = thumbnail_of(mesh.wedges.textures[k], *meanings[k]);
    } catch (const InputError&) {  // a file keeps images that are damaged or foreign as they are
    } catch (const UnsupportedError&) {
    }
  }
  return out;
}

}  // namespace lodestone
