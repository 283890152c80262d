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

Appearance appearance_of(const Hierarchy& hierarchy, Appearance appearance) {
  const bool coloured = (appearance.vertex_colours && hierarchy.attributes.colours) ||
                        (appearance.textures && has_surface_colours(hierarchy));
  if (coloured) appearance.base_colour = {1, 1, 1};
  return appearance;
}

}  // namespace lodestone
