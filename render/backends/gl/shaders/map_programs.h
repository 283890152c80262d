// The programs that draw position maps.
#pragma once

#include "render/backends/gl/device/object.h"

namespace lodestone {

// Storage blocks of both programs.
inline constexpr GLuint map_positions_block = 0, map_triangles_block = 1, map_uv_block = 2, map_colour_block = 3;
// Uniforms of both programs.
enum MapUniform : GLint {
  map_eye = 0,
  map_right = 1,
  map_up = 2,
  map_forward = 3,
  map_pixel = 4,
  map_size = 5,
  map_central = 6,
  map_depth_range = 7,  // what becomes window depth 0, and 1 over the extent
  map_channels = 8      // 1: uv, 2: colour
};
// Colour attachments of the second program's target.
inline constexpr GLuint map_position_target = 0, map_normal_target = 1, map_uv_target = 2, map_colour_target = 3;

// First program: the number of the nearest triangle into an R32UI target. Vertices are snapped to 1/256 pixel in double
// precision; row 0 of the map is row 0 of the target. Throw UnsupportedError where the driver refuses a program.
[[nodiscard]] GlProgram make_map_sight_program();
// Second program: resolve_pixel.h for the triangles that texture unit 0 holds; draw_screen
// (render/backends/gl/device/program.h).
[[nodiscard]] GlProgram make_map_resolve_program();

}  // namespace lodestone
