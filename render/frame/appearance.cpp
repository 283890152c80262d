#include "render/frame/appearance.h"

#include <algorithm>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

bool has_surface_colours(const Hierarchy& hierarchy) {
  return std::ranges::any_of(hierarchy.materials, [&](const Material& m) {
    const bool coloured = m.base_colour[0] != 1 || m.base_colour[1] != 1 || m.base_colour[2] != 1;
    return coloured || (m.texture != no_texture && hierarchy.attributes.uv);
  });
}

bool has_normal_maps(const Hierarchy& hierarchy) {
  return hierarchy.attributes.uv &&
         std::ranges::any_of(hierarchy.materials, [](const Material& m) { return m.normal_map != no_texture; });
}

bool has_occlusion_maps(const Hierarchy& hierarchy) {
  return hierarchy.attributes.uv && std::ranges::any_of(hierarchy.materials, [](const Material& m) {
           return m.occlusion.texture != no_texture && m.occlusion_strength > 0;
         });
}

bool has_emission(const Hierarchy& hierarchy) {
  return std::ranges::any_of(hierarchy.materials,
                             [](const Material& m) { return m.emissive != std::array<float, 3>{} && !m.unlit; });
}

bool has_unlit_materials(const Hierarchy& hierarchy) {
  return std::ranges::any_of(hierarchy.materials, &Material::unlit);
}

bool has_materials_of(const Hierarchy& hierarchy, AlphaMode mode) {
  return std::ranges::find(hierarchy.materials, mode, &Material::alpha_mode) != hierarchy.materials.end();
}

bool has_one_sided_materials(const Hierarchy& hierarchy) {
  return std::ranges::find(hierarchy.materials, false, &Material::double_sided) != hierarchy.materials.end();
}

Appearance appearance_of(const Hierarchy& hierarchy, Appearance appearance) {
  const bool coloured = (appearance.vertex_colours && hierarchy.attributes.colours) ||
                        (appearance.textures &&
                         (has_surface_colours(hierarchy) || has_emission(hierarchy) || has_unlit_materials(hierarchy)));
  if (coloured) appearance.base_colour = {1, 1, 1};
  return appearance;
}

}  // namespace lodestone
