// What of a model's own looks there is to show.
#pragma once

#include "core/hierarchy/model/hierarchy.h"
#include "render/frame/frame.h"

namespace lodestone {

// Has it materials that show a texture or a colour other than white?
[[nodiscard]] bool has_surface_colours(const Hierarchy& hierarchy);
[[nodiscard]] bool has_normal_maps(const Hierarchy& hierarchy);

// The look with the base colour that a model takes when nobody names one: white where the look shows colours of its
// own, those of vertices, materials and textures, so that they are seen as they are; else as it is.
[[nodiscard]] Look look_of(const Hierarchy& hierarchy, Look look = {});

}  // namespace lodestone
