// The programs of the gl backend: the morph (morph_source.h) and the code of the effects that are called for.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/hierarchy/model/cell_code.h"
#include "core/hierarchy/model/distance_metric.h"
#include "render/backends/gl/device/object.h"
#include "render/frame/frame.h"

namespace lodestone {

// The output of the triangles: the picture, depths seen from the light and what layers let through of it, a count,
// fronts less backs, or lists of layers.
enum class GlPass : std::uint8_t { picture, shadow, shadow_layers, count, winding, layers, layers_4x };

// A program is compiled for one blending function, one metric and one set of effects: software rasterizers execute both
// sides of a branch.
struct GlVariant {
  Blend blend = Blend::smoothstep;
  DistanceMetric metric = DistanceMetric::euclidean;
  bool limited = false;  // detail limits hold (render/lod/limits.h), and the program finds lambda
  bool given = false;    // the program is given lambda: adaptive radii
  bool face_normals = false;
  EffectSet effects;
  GlPass pass = GlPass::picture;
  std::uint32_t material_bits = 0;  // what it does with materials besides their colours
  bool clipped = false;             // by ModelFrame::clip
  friend auto operator<=>(const GlVariant&, const GlVariant&) = default;
};
// Triangles of blended materials are left out; or those of all others; alpha is looked at; the models' vertices have
// alpha; the backs of single-sided materials are left out.
inline constexpr std::uint32_t leaves_out_blended = 1, leaves_out_others = 2, reads_alpha = 4, reads_vertex_alpha = 8,
                               leaves_out_backs = 16;
[[nodiscard]] GlVariant variant_of(const Frame& frame, const ModelFrame& model, GlPass pass);

// Attributes of the vertex array.
inline constexpr GLuint own_position = 0, own_normal = 1, parent_index = 2, draw_record = 3, signature_place = 7;
// Attributes that only some models have; only in programs of effects that read them.
inline constexpr GLuint own_uv = 4, own_colour = 5, own_material = 6;
// Storage blocks: the vertices of the group again, to be read at the parent's place.
inline constexpr GLuint positions_block = 0, normals_block = 1;
// The frame's detail limits, only in the limited variant; or its lambdas, only in the given one.
inline constexpr GLuint limits_block = 2, lambdas_block = 2;
// The models of the frame.
inline constexpr GLuint instances_block = 3;
// Attributes of the group again, as above.
inline constexpr GLuint uv_block = 4, colours_block = 5;
// Textures of all models (render/backends/gl/scene/textures.h).
inline constexpr GLuint materials_block = 6, texture_levels_block = 7;
inline constexpr GLuint texture_pages_unit = 4;
// Uniform block.
inline constexpr GLuint frame_block = 0;

// Per draw, read as an attribute that advances with the instance: a command's base instance names its record.
struct GlDrawRecord {
  std::uint32_t parent_first_vertex = 0;  // of the parent cell, in the group's vertices
  std::uint32_t bits = 0;                 // level, morphs_bit (else lambda = 1 for all vertices), number of the model
  // The detail limits near the cell; or, in the given variant, the first of the lambdas of its signatures.
  std::uint32_t first_limit = 0, end_limit = 0;
};
inline constexpr std::uint32_t morphs_bit = 256, instance_shift = 9;

// A detail limit, std430.
struct GlLimit {
  float lo[3] = {}, radius = 0;
  float hi[3] = {}, unused = 0;
};

// A model of the frame, std430.
struct GlLevel {
  float band_begin = 0, band_end = 0, unused[2] = {};
  float tint[4] = {};
};
struct GlInstance {
  float clip_rows[4][4] = {};   // of the view projection
  float light_rows[4][4] = {};  // of the light projection
  // Beside each of these in w: the normal of the clipping plane; its distance, as bits, in flags.
  float viewpoint[4] = {};
  float towards_eye[4] = {};
  float towards_light[4] = {};
  float eye[4] = {};            // render/camera/projection.h
  float base_colour[4] = {};    // w: opacity
  std::uint32_t flags[4] = {};  // flags, first entry of the model's materials, the one after it if there is any
  std::array<GlLevel, max_level + 1> levels{};
};
inline constexpr std::uint32_t smooth_flag = 1, colours_flag = 2, textures_flag = 4, normal_maps_flag = 8,
                               has_uv_flag = 16, has_materials_flag = 32;

// The uniform block, std140.
struct GlFrameUniforms {
  float fog[4] = {};   // colour, density
  float lens[4] = {};  // tan_x, tan_y, near, far
  float size[2] = {};  // pixels
  float ambient = 0, head_strength = 0;
  float directional_strength = 0, shadow_strength = 0, level_tint = 0, wireframe = 0;
};

[[nodiscard]] GlInstance instance_of(const ModelFrame& model, std::uint32_t first_material);
[[nodiscard]] GlFrameUniforms uniforms_of(const Frame& frame);

// Draws triangles; every vertex also gives its morphed position to transform feedback buffer 0, so that what a test
// captures comes from the program that draws (not in programs with a geometry stage). Throws UnsupportedError with the
// compiler's log when the driver refuses it.
[[nodiscard]] GlProgram make_draw_program(GlVariant variant);

}  // namespace lodestone
