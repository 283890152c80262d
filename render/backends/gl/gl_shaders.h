// The programs of the gl backend: the morph of render/lod/morph.h in GLSL, operation by operation.
#pragma once

#include <array>
#include <string>

#include "core/hierarchy/cell_code.h"
#include "core/hierarchy/distance_metric.h"
#include "render/backends/gl/gl_object.h"
#include "render/lod/blend.h"

namespace lodestone {

// A program is compiled for one blending function and one metric: software rasterizers execute both sides of a branch.
struct GlVariant {
  Blend blend = Blend::smoothstep;
  DistanceMetric metric = DistanceMetric::euclidean;
  bool limited = false;  // detail limits hold (render/lod/limits.h)
  friend auto operator<=>(const GlVariant&, const GlVariant&) = default;
};

// Attributes of the vertex array.
inline constexpr GLuint own_position = 0, own_normal = 1, parent_index = 2, draw_record = 3;
// Storage blocks: the vertices of the group again, to be read at the parent's place.
inline constexpr GLuint positions_block = 0, normals_block = 1;
// The frame's detail limits; only in the limited variant.
inline constexpr GLuint limits_block = 2;
// Uniform block.
inline constexpr GLuint frame_block = 0;

// Per draw, read as an attribute that advances with the instance: a command's base instance names its record.
struct GlDrawRecord {
  std::uint32_t parent_first_vertex = 0;  // of the parent cell, in the group's vertices
  std::uint32_t level = 0;                // plus 256 when the cell morphs; else lambda = 1 for all of its vertices
  std::uint32_t first_limit = 0, end_limit = 0;
};
inline constexpr std::uint32_t morphs_bit = 256;

// A detail limit, std430.
struct GlLimit {
  float lo[3] = {}, radius = 0;
  float hi[3] = {}, unused = 0;
};

// The uniform block, std140.
struct GlLevelUniforms {
  float band_begin = 0, band_end = 0, unused[2] = {};
  float albedo[4] = {};
};
struct GlFrameUniforms {
  std::array<std::array<float, 4>, 4> clip_rows{};  // of the view projection
  float viewpoint[4] = {};
  float light[4] = {};    // w: ambient share
  float shading[4] = {};  // x: least squared length of a normal
  std::array<GlLevelUniforms, max_level + 1> levels{};
};

// Source of the function `morph_vertex` and all it calls, without version line; see GlVariant.
[[nodiscard]] std::string morph_source(GlVariant variant);

// Draws triangles; every vertex also gives its morphed position to transform feedback buffer 0, so that what a test
// captures comes from the program that draws. Throws UnsupportedError with the compiler's log when the driver refuses
// it.
[[nodiscard]] GlProgram make_draw_program(GlVariant variant);

}  // namespace lodestone
