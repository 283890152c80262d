#include "render/frame/look.h"

#include <algorithm>

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

Look look_of(const Hierarchy& hierarchy, Look look) {
  const bool coloured =
      (look.vertex_colours && hierarchy.attributes.colours) || (look.textures && has_surface_colours(hierarchy));
  if (coloured) look.base_colour = {1, 1, 1};
  return look;
}

}  // namespace lodestone
