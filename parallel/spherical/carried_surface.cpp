#include "parallel/spherical/carried_surface.h"

#include <algorithm>

namespace lodestone {
namespace {

// The material without its images and what they multiply.
Material without_images(const Material& from, std::set<std::string>& left_out) {
  Material m = from;
  const Material none;
  const auto drop = [&](const char* what) { left_out.insert(std::string(what) + " of materials are left out"); };
  if (m.metallic_roughness.texture != no_texture) {
    m.metallic = none.metallic, m.roughness = none.roughness;
    drop("images of metal and roughness");
  }
  if (m.occlusion.texture != no_texture) drop("images of occlusion");
  if (m.emissive_map.texture != no_texture) {
    m.emissive = none.emissive;
    drop("images of light");
  }
  if (std::ranges::any_of(m.extension_textures, [](std::uint32_t t) { return t != no_texture; })) {
    m.extensions.clear();
    drop("extensions with images");
  }
  return m;
}

}  // namespace

std::uint32_t material_of(const IndexedMesh& mesh, TriangleId triangle) {
  const WedgeAttributes& wedges = mesh.wedges;
  if (wedges.materials.empty()) return no_material;
  return wedges.material.empty() ? 0 : wedges.material[mesh.triangles[triangle].v[0]];
}

Material carried_surface(const IndexedMesh& mesh, const std::set<std::uint32_t>& materials,
                         std::set<std::string>& left_out) {
  const Material none;
  Material kept;
  bool first = true;
  for (const std::uint32_t number : materials) {
    const Material m = number == no_material ? none : without_images(mesh.wedges.materials[number], left_out);
    const auto keep = [&](const char* what, auto... fields) {
      const auto one = [&](auto field) {
        if (first || kept.*field == m.*field) {
          kept.*field = m.*field;
          return;
        }
        kept.*field = none.*field;
        left_out.insert(std::string(what) + " of materials that share an image differ and are left out");
      };
      (one(fields), ...);
    };
    keep("metal and roughness", &Material::metallic, &Material::roughness);
    keep("light of their own", &Material::emissive, &Material::unlit);
    keep("modes of alpha", &Material::alpha_mode, &Material::alpha_cutoff);
    keep("sides", &Material::double_sided);
    keep("extensions", &Material::extensions);
    first = false;
  }
  return kept;
}

}  // namespace lodestone
