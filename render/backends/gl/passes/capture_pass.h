// The triangles that commands draw, as the vertex shader computed them, by transform feedback. Makes no picture.
#pragma once

#include <functional>
#include <vector>

#include "render/backends/gl/scene/commands.h"

namespace lodestone {

// The drawn positions of their corners, three a triangle, in the order of drawing.
[[nodiscard]] std::vector<Vec3f> capture_triangles(const GlCommands& commands, const GlScene& scene,
                                                   const std::function<void(const GlPipeline&)>& use);

}  // namespace lodestone
