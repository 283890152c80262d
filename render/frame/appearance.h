// Contributions of the materials and colours of a model to its appearance.
#pragma once

#include "core/mesh/attributes.h"
#include "render/frame/frame.h"

namespace lodestone {

struct Hierarchy;

// True if it has materials that show a texture or a colour other than white.
[[nodiscard]] bool has_surface_colours(const Hierarchy& hierarchy);
[[nodiscard]] bool has_normal_maps(const Hierarchy& hierarchy);
[[nodiscard]] bool has_occlusion_maps(const Hierarchy& hierarchy);
[[nodiscard]] bool has_emission(const Hierarchy& hierarchy);
[[nodiscard]] bool has_unlit_materials(const Hierarchy& hierarchy);
[[nodiscard]] bool has_materials_of(const Hierarchy& hierarchy, AlphaMode mode);
[[nodiscard]] bool has_one_sided_materials(const Hierarchy& hierarchy);

// The appearance with the base colour that a model takes by default: white where colours of its own are shown, those of
// vertices, materials and textures, so that they are seen unchanged; else as it is.
[[nodiscard]] Appearance appearance_of(const Hierarchy& hierarchy, Appearance appearance = {});

}  // namespace lodestone
