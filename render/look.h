// What of a model's own looks there is to show.
#pragma once

#include "core/hierarchy/hierarchy.h"
#include "render/frame.h"

namespace lodestone {

// Has it materials that show a texture or a colour other than white?
[[nodiscard]] bool has_surface_colours(const Hierarchy& hierarchy);
[[nodiscard]] bool has_normal_maps(const Hierarchy& hierarchy);

// How a model looks when nobody says otherwise: in its own colours, those of vertices, materials and textures, where it
// has any, times white; else in the plain albedo of render/shading.h.
[[nodiscard]] Look look_of(const Hierarchy& hierarchy);

}  // namespace lodestone
