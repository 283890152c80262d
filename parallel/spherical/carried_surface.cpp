#include "parallel/spherical/carried_surface.h"

#include <algorithm>
#include <array>

#include "core/formats/gltf/gltf_surface.h"
#include "core/spherical/resample/mesh_source.h"

namespace lodestone {
namespace {

const Material& material_at(const IndexedMesh& mesh, std::uint32_t number) {
  static const Material none;
  return number == no_material ? none : mesh.wedges.materials[number];
}

// The material as it is where the images of `drawn` say what they differ in.
Material as_drawn(const Material& from, const MaterialMaps& drawn) {
  Material m = from;
  if (drawn.metal_and_roughness) m.metallic_roughness = {}, m.metallic = m.roughness = 1;
  if (drawn.occlusion) m.occlusion = {}, m.occlusion_strength = 1;
  if (drawn.emission) {
    m.emissive_map = {}, m.emissive = {1, 1, 1};
    set_emissive_strength(m, 1);
  }
  return m;
}

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
  if (m.emissive_map.texture != no_texture && m.emissive != none.emissive) {
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

MaterialMaps material_maps(const IndexedMesh& mesh, const std::set<std::uint32_t>& materials) {
  MaterialMaps maps;
  const bool textured = !mesh.wedges.uv.empty();
  const auto light = [](const Material& m) {
    std::array<float, 3> own = m.unlit ? std::array<float, 3>{} : m.emissive;
    for (float& channel : own) channel *= emissive_strength(m);
    return own;
  };
  for (const std::uint32_t number : materials) {
    const Material &m = material_at(mesh, number), &first = material_at(mesh, *materials.begin());
    maps.metal_and_roughness |= (textured && m.metallic_roughness.texture != no_texture) ||
                                m.metallic != first.metallic || m.roughness != first.roughness;
    maps.occlusion |= textured && m.occlusion.texture != no_texture;
    maps.emission |= (textured && m.emissive_map.texture != no_texture && light(m) != std::array<float, 3>{}) ||
                     light(m) != light(first);
  }
  return maps;
}

Material carried_surface(const IndexedMesh& mesh, const std::set<std::uint32_t>& materials, const MaterialMaps& drawn,
                         std::set<std::string>& left_out) {
  const Material none;
  Material kept;
  bool first = true;
  for (const std::uint32_t number : materials) {
    const Material m = without_images(as_drawn(material_at(mesh, number), drawn), left_out);
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
  if (drawn.emission) set_emissive_strength(kept, spherical::strongest_emission(mesh));
  return kept;
}

}  // namespace lodestone
