// The view of a directional light onto the scene: the frame of its shadow map, fitted around the receivers and casters
// of shadows.
//
// The projection is parallel (williams1978). Shadows must not crawl when the camera moves: the map's side takes one of
// a few sizes, its texels lie on a lattice that is fixed in the world, and its axes depend on the light alone. So the
// map moves by whole texels from frame to frame, and each texel samples the same points.
#pragma once

#include <array>
#include <span>

#include "core/math/vec3.h"
#include "render/camera/projection.h"

namespace lodestone {

// Row-major 3x4, from normalised model space to the world.
using ModelPlacement = std::array<double, 12>;
inline constexpr ModelPlacement no_placement{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// Orthonormal axes and a box along them, in world units.
struct LightView {
  Vec3d right{1, 0, 0}, up{0, 1, 0}, towards_light{0, 0, 1};
  double centre_x = 0, centre_y = 0, half = 1;  // along right and up: the square that the map covers
  double near = 1, far = -1;                    // along towards_light; near is the greater one
  friend bool operator==(const LightView&, const LightView&) = default;
};

// Fits the view around the receivers sideways and around receivers and casters in depth, with room for shadow_margin
// texels. `towards_light` is of any length but 0; `texels` is a side of the map, at least 4 shadow_margin. Points are
// in world space, as corners_of returns them; without receivers the view is that of a unit square. Throws InputError if
// a number is not finite.
inline constexpr int shadow_margin = 4;
[[nodiscard]] LightView fit_light(Vec3d towards_light, std::span<const Vec3d> receivers, std::span<const Vec3d> casters,
                                  int texels);

// ModelFrame::light_projection of a model: orthogonal, clip w = 1. Computed in double, rounded once.
[[nodiscard]] ViewProjection light_projection(const LightView& view, const ModelPlacement& placement);

// Corners of a box of normalised model space, in the world.
[[nodiscard]] std::array<Vec3d, 8> corners_of(const Box3f& box, const ModelPlacement& placement);

}  // namespace lodestone
