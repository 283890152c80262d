// Every copy of a vertex must come out with the same bits, whichever cell it is drawn with: `precise` keeps the order
// of operations and forbids fused multiply-adds, `invariant` does it for the clip position, and the inputs are global
// (w, P(w), viewpoint), never relative to a cell.
#include "render/backends/gl/shaders/draw_program.h"

#include <utility>
#include <vector>

#include "render/backends/gl/device/program.h"
#include "render/backends/gl/shaders/morph_source.h"
#include "render/backends/gl/shaders/varyings.h"
#include "render/effects/effect_info.h"
#include "render/effects/material_alpha.h"
#include "render/effects/texture_mapping.h"
#include "render/effects/vertex_colours.h"
#include "render/frame/shading.h"
#include "render/textures/surface_textures.h"

namespace lodestone {
namespace {

// Declarations that all stages and effects may read; see GlFrameUniforms and GlInstance.
constexpr const char* frame_source = R"(
layout(std140, binding = 0) uniform Frame {
  vec4 fog;
  vec4 lens;
  vec2 size;
  float ambient, head_strength;
  float directional_strength, shadow_strength, level_tint, wireframe;
} frame;

struct Level {
  vec4 band;  // begin a_l, end c_l
  vec4 tint;
};
struct Instance {
  vec4 clip_rows[4];
  vec4 light_rows[4];
  vec4 viewpoint;
  vec4 towards_eye;
  vec4 towards_light;
  vec4 eye;
  vec4 base_colour;
  uvec4 flags;
  Level levels[LEVELS];
};
layout(std430, binding = 3) readonly restrict buffer Instances { Instance instances[]; };
uint instance;  // whose vertex or pixel this is
const float least_norm2 = 1e-12;
const vec3 wire_colour = vec3(0.05, 0.06, 0.08);
const float wire_half_width = 0.75;

bool instance_flag(uint flag) { return (instances[instance].flags.x & flag) != 0u; }
)";
static_assert(shading::least_norm2 == 1e-12f && shading::wire_half_width == 0.75f &&
              shading::wire_colour == Vec3f{0.05f, 0.06f, 0.08f});

constexpr const char* vertex_head = R"(
layout(std430, binding = 0) readonly restrict buffer Positions { float positions[]; };

layout(location = 0) in vec3 own_position;
layout(location = 2) in uint parent_index;
layout(location = 3) in uvec4 draw;  // as GlDrawRecord

invariant gl_Position;
layout(xfb_buffer = 0, xfb_stride = 12, xfb_offset = 0) out vec3 drawn_position;
flat out uint drawn_instance;

// Values of this vertex, for the effects.
uint level, parent;  // the parent's number among the vertices of the group; only where lambda < 1
float lambda = 1.0;
)";

constexpr const char* vertex_main = R"(
void main() {
  level = draw.y & 255u;
  instance = drawn_instance = draw.y >> 9;
  precise vec3 p = own_position;
#ifdef LIMITED
  limit_range = draw.zw;
#endif
#ifdef GEOMORPH
  if ((draw.y & 256u) != 0u) {
    lambda = lambda_of_vertex();
    if (lambda < 1.0) {
      parent = draw.x + parent_index;
      vec3 parent_position = vec3(positions[3u * parent], positions[3u * parent + 1u], positions[3u * parent + 2u]);
      p = morph_position(lambda, own_position, parent_position);
    }
  }
#endif
  drawn_position = p;
  EFFECTS
  precise vec4 clip;
  for (int i = 0; i < 4; ++i) {
    vec4 row = instances[instance].CLIP_ROWS[i];
    clip[i] = ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
  }
  gl_Position = clip;
#ifdef CLIPPED
  vec3 clip_normal =
      vec3(instances[instance].viewpoint.w, instances[instance].towards_eye.w, instances[instance].towards_light.w);
  gl_ClipDistance[0] = dot(clip_normal, p) + uintBitsToFloat(instances[instance].flags.w);
#endif
#ifdef LEFT_OUT_MODES
  if ((LEFT_OUT_MODES >> materials[material].flags.x & 1u) != 0u) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
#endif
}
)";

// render/frame/shading.h
constexpr const char* fragment_head = R"(
in vec3 drawn_position;
flat in uint drawn_instance;

struct Surface {
  vec3 normal;  // model space, of any length
  vec3 colour;  // albedo, and in the end the colour of the picture
  float ambient;  // light from everywhere
  float light;  // sum of the lights that reach it
  float directional;  // that of the directional light, in it
};
)";

constexpr const char* fragment_main = R"(
void main() {
  instance = drawn_instance;
  Surface s = Surface(vec3(0.0, 0.0, 1.0), instances[instance].base_colour.rgb, frame.ambient, 0.0, 0.0);
#ifdef FACE_NORMALS
  s.normal = cross(dFdx(drawn_position), dFdy(drawn_position));
#endif
  EFFECTS_BEFORE_LIGHT
  s.colour *= s.ambient + (1.0 - frame.ambient) * min(s.light, 1.0);
  EFFECTS_AFTER_LIGHT
  float opacity = instances[instance].base_colour.w;
#ifdef LEAVES_OUT_BACKS
  if (!gl_FrontFacing && materials[material].flags.y != 0u) discard;
#endif
#ifdef READS_ALPHA
  float of_material = opacity_of_material();
  if (!(of_material > 0.0)) discard;
  opacity *= of_material;
#endif
  OUTPUT
}
)";

// The last effect that changes albedo, normal or light.
constexpr Effect last_before_light = Effect::unlit;

// The output of the colour. Layers are added to the pixel's list (render/backends/gl/passes/layers_pass.h); tests of
// depth come first there.
constexpr const char* picture_output = "layout(location = 0) out vec4 colour;\n";
constexpr const char* store_picture = "colour = vec4(s.colour, 1.0);";
constexpr const char* layers_output = R"(
layout(early_fragment_tests) in;
layout(std430, binding = 8) restrict buffer Heads { uint count, width, heads[]; };
layout(std430, binding = 9) restrict buffer Nodes { uint nodes[]; };
)";
constexpr const char* store_layer = R"(
#ifdef MULTISAMPLED
  const uint words = 7u;
  vec2 slope = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z));
#else
  const uint words = 4u;
#endif
  uint number = atomicAdd(count, 1u), at = words * number;
  if (at + words <= uint(nodes.length())) {
    nodes[at] = atomicExchange(heads[uint(gl_FragCoord.y) * width + uint(gl_FragCoord.x)], number + 1u);
    nodes[at + 1u] = floatBitsToUint(gl_FragCoord.z);
    nodes[at + 2u] = packUnorm2x16(s.colour.rg);
    nodes[at + 3u] = packUnorm2x16(vec2(s.colour.b, opacity));
#ifdef MULTISAMPLED
    nodes[at + 4u] = floatBitsToUint(slope.x);
    nodes[at + 5u] = floatBitsToUint(slope.y);
    nodes[at + 6u] = uint(gl_SampleMaskIn[0]);
#endif
  }
)";

// Fragment stages of the passes that shade no surface.
constexpr const char* count_source = R"(
layout(location = 0) out float count;
void main() { count = 1.0; }
)";
constexpr const char* winding_source = R"(
layout(location = 0) out float winding;
void main() { winding = gl_FrontFacing ? 1.0 : -1.0; }
)";
constexpr const char* depth_source = "void main() {}\n";
constexpr const char* light_outputs = R"(
layout(location = 0) out vec4 through;  // multiplied by 1 less its alpha
layout(location = 1) out float first;   // the smallest one is kept
)";
// Seen from the light: masked materials, and layers.
constexpr const char* light_main = R"(
void main() {
  instance = drawn_instance;
  float opacity = instances[instance].base_colour.w;
#ifdef READS_ALPHA
  map_texture();
  opacity *= opacity_of_material();
#endif
  if (!(opacity > 0.0)) discard;
  OUTPUT
}
)";
constexpr const char* store_light = "through = vec4(opacity);\n  first = gl_FragCoord.z;";

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

// Code of the effects of a set, and their calls.
struct EffectSource {
  std::string vertex, vertex_calls, geometry, geometry_calls, fragment, calls_before_light, calls_after_light;
};
EffectSource effect_source(EffectSet effects, std::uint32_t material_bits) {
  EffectSource source;
  if (material_bits != 0 || effects.contains_any({Effect::texture, Effect::normal_map, Effect::occlusion_map,
                                                  Effect::unlit, Effect::emission})) {
    source.vertex = std::string(effects::material_source) + std::string(effects::mapping_vertex);
    source.fragment = std::string(effects::material_source) + std::string(effects::mapping_fragment);
    source.vertex_calls = source.calls_before_light = "map_texture();\n  ";
  }
  const bool vertex_alpha = (material_bits & reads_vertex_alpha) != 0;
  if (vertex_alpha || effects.contains(Effect::vertex_colours)) source.vertex += effects::colours_vertex;
  if (vertex_alpha) {
    source.vertex += effects::vertex_alpha_vertex;
    source.vertex_calls += "find_vertex_alpha();\n  ";
  }
  if (material_bits & reads_alpha) {
    source.fragment += vertex_alpha ? effects::vertex_alpha_fragment : effects::no_vertex_alpha_fragment;
    source.fragment += effects::opacity_fragment;
  }
  for (const EffectInfo& info : effect_infos()) {
    if (!effects.contains(info.effect)) continue;
    const std::string name = glsl_name(info.effect);
    if (!info.glsl.vertex.empty()) {
      source.vertex += info.glsl.vertex;
      source.vertex_calls += name + "();\n  ";
    }
    if (!info.glsl.geometry.empty()) {
      source.geometry += info.glsl.geometry;
      source.geometry_calls += "    " + name + "();\n";
    }
    if (!info.glsl.fragment.empty()) {
      source.fragment += info.glsl.fragment;
      (info.effect <= last_before_light ? source.calls_before_light : source.calls_after_light) += name + "(s);\n  ";
    }
  }
  return source;
}

std::string define(bool defined, const char* name) { return defined ? std::string("#define ") + name + "\n" : ""; }

std::string frame_block_source() {
  std::string flags;
  for (const auto& [name, value] : {std::pair{"smooth_flag", smooth_flag},
                                    {"colours_flag", colours_flag},
                                    {"textures_flag", textures_flag},
                                    {"normal_maps_flag", normal_maps_flag},
                                    {"has_uv_flag", has_uv_flag},
                                    {"has_materials_flag", has_materials_flag},
                                    {"no_texture", no_texture}})
    flags += std::string("const uint ") + name + " = " + std::to_string(value) + "u;\n";
  return "#define LEVELS " + std::to_string(max_level + 1) + "\n" + frame_source + flags;
}

}  // namespace

GlProgram make_draw_program(GlVariant variant) {
  std::vector<GlStage> stages;
  const EffectSource source = effect_source(variant.effects, variant.material_bits);
  const std::string head = define(variant.pass == GlPass::layers_4x, "MULTISAMPLED") +
                           define(variant.limited, "LIMITED") +
                           define(variant.effects.contains(Effect::geomorph), "GEOMORPH") +
                           define(variant.clipped, "CLIPPED") + define(variant.face_normals, "FACE_NORMALS") +
                           define(variant.material_bits & leaves_out_blended, "LEFT_OUT_MODES 4u") +
                           define(variant.material_bits & leaves_out_others, "LEFT_OUT_MODES 3u") +
                           define(variant.material_bits & reads_alpha, "READS_ALPHA") +
                           define(variant.material_bits & leaves_out_backs, "LEAVES_OUT_BACKS") + frame_block_source();
  const bool through = variant.pass == GlPass::shadow_layers, from_light = variant.pass == GlPass::shadow || through;
  std::string vertex = vertex_head + lambda_source(variant) + source.vertex +
                       replaced(replaced(vertex_main, "EFFECTS", source.vertex_calls), "CLIP_ROWS",
                                from_light ? "light_rows" : "clip_rows");
  const bool layers = variant.pass == GlPass::layers || variant.pass == GlPass::layers_4x;
  const std::string main = replaced(replaced(replaced(fragment_main, "EFFECTS_BEFORE_LIGHT", source.calls_before_light),
                                             "EFFECTS_AFTER_LIGHT", source.calls_after_light),
                                    "OUTPUT", layers ? store_layer : store_picture);
  std::string fragment =
      (layers ? layers_output : picture_output) + std::string(fragment_head) + source.fragment + main;
  if (variant.pass == GlPass::count) fragment = count_source;
  if (variant.pass == GlPass::winding) fragment = winding_source;
  if (from_light)
    fragment = (through ? light_outputs : "") + std::string(fragment_head) + source.fragment +
               replaced(light_main, "OUTPUT", through ? store_light : "");
  if (variant.pass == GlPass::shadow && !(variant.material_bits & reads_alpha)) fragment = depth_source;
  if (!source.geometry.empty()) {
    // Feedback would have to come from the geometry stage; the output of these programs is never captured.
    vertex = replaced(vertex, "layout(xfb_buffer = 0, xfb_stride = 12, xfb_offset = 0) ", "");
    const std::vector<GlVarying> from_vertices = varyings_of(vertex, "out"), own = varyings_of(source.geometry, "out");
    std::vector<GlVarying> order = from_vertices;
    order.insert(order.end(), own.begin(), own.end());
    stages.push_back(
        {GL_GEOMETRY_SHADER, head + geometry_source(from_vertices, order, source.geometry, source.geometry_calls)});
    vertex = with_locations(vertex, "out", order);
    fragment = with_locations(fragment, "in", order);
  }
  stages.push_back({GL_VERTEX_SHADER, head + morph_source(variant) + vertex});
  stages.push_back({GL_FRAGMENT_SHADER, head + fragment});
  return link_program(stages);
}

}  // namespace lodestone
