// The appearance of a model, and what its own materials and colours contribute to it.
#pragma once

#include "core/math/vec3.h"
#include "core/mesh/material.h"
#include "render/frame/shading.h"

namespace lodestone {

struct Hierarchy;

// How a placed model looks; its own materials, textures and colours are in its hierarchy. Colours as the picture has
// them, each channel in [0, 1], without a transfer curve.
struct Appearance {
  Vec3f base_colour = shading::albedo;  // times vertex colour, material and texture
  float opacity = 1;                    // in [0, 1]
  bool smooth = true;                   // normals interpolated over a triangle; false: one for each triangle
  // Those that the model has are shown. `textures` are its materials, alpha and sides included.
  bool vertex_colours = true, textures = true, normal_maps = true;
  friend bool operator==(const Appearance&, const Appearance&) = default;
};

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
