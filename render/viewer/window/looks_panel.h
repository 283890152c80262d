// The parts of the panel about the whole scene: its models, its light and background, its effects.
#pragma once

#include "render/viewer/session/view_drawing.h"

namespace lodestone::viewer {

// The names of several models, each with a switch; nothing for one.
void edit_models(const Scene& scene, Looks& looks);

// `up` is the axis that the light turns about.
void edit_light(Vec3d up, Looks& looks);

void edit_clip(ClipChoice& clip);

// Effects of the last frame, each with a switch; `radius` is that of the scene.
void edit_effects(const Frame& frame, double radius, Looks& looks);

}  // namespace lodestone::viewer
