// Every copy of a vertex must come out with the same bits, whichever cell it is drawn with: `precise` keeps the order
// of operations and forbids fused multiply-adds, `invariant` does it for the clip position, and the inputs are global
// (w, P(w), viewpoint), never relative to a cell.
#include "render/backends/gl/gl_shaders.h"

#include "core/base/error.h"

namespace lodestone {
namespace {

constexpr const char* version_line = "#version 450 core\n";

constexpr const char* frame_source = R"(
struct Level {
  vec4 band;    // begin a_l, end c_l
  vec4 albedo;
};
layout(std140, binding = 0) uniform Frame {
  vec4 clip_rows[4];
  vec4 viewpoint;
  vec4 light;    // w: ambient share
  vec4 shading;  // x: least squared length of a normal
  Level levels[LEVELS];
} frame;
)";

// distance_metric.h
constexpr const char* euclidean_source = R"(
float norm(vec3 a) {
  precise float sum = (a.x * a.x + a.y * a.y) + a.z * a.z;
  precise float root = sqrt(sum);
  return root;
}
)";
constexpr const char* chebyshev_source = R"(
float norm(vec3 a) { return max(max(a.x, a.y), a.z); }
)";

// blend.cpp
const char* share_source(Blend blend) {
  switch (blend) {
    case Blend::linear:
      return "float share(float t) { return t; }\n";
    case Blend::smoothstep:
      return "float share(float t) { return cubic(t); }\n";
    case Blend::smootherstep:
      return R"(
float share(float t) {
  precise float s = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
  return s;
}
)";
    case Blend::cosine:
      return R"(
float share(float t) {
  precise float s = (1.0 - cos(3.14159265358979 * t)) / 2.0;
  return s;
}
)";
    case Blend::early:
      return "float share(float t) { precise float u = min(2.0 * t, 1.0); return cubic(u); }\n";
    case Blend::late:
      return "float share(float t) { precise float u = max(2.0 * t - 1.0, 0.0); return cubic(u); }\n";
    case Blend::step:
      return "float share(float t) { return t < 0.5 ? 0.0 : 1.0; }\n";
  }
  return "";
}

// limits.cpp
constexpr const char* unlimited_source = "float limited(float d, vec3 w) { return d; }\n";
constexpr const char* limited_source = R"(
struct Limit { vec4 lo_radius; vec4 hi; };
layout(std430, binding = 2) readonly restrict buffer Limits { Limit limits[]; };
uvec2 limit_range;  // of the draw

float limited(float d, vec3 w) {
  for (uint i = limit_range.x; i < limit_range.y; ++i) {
    vec4 lo_radius = limits[i].lo_radius;
    precise vec3 outside = max(max(lo_radius.xyz - w, w - limits[i].hi.xyz), vec3(0.0));
    precise float at_least = lo_radius.w - norm(outside);
    d = max(d, at_least);
  }
  return d;
}
)";

// morph.cpp and unpack_normal of hierarchy.cpp
constexpr const char* morph_functions = R"(
float blend_share(float t) {
  if (!(t > 0.0)) return 0.0;
  if (t >= 1.0) return 1.0;
  return clamp(share(t), 0.0, 1.0);
}

float morph_lambda(uint level, vec3 w) {
  float begin = frame.levels[level].band.x, end = frame.levels[level].band.y;
  precise vec3 apart = abs(w - frame.viewpoint.xyz);
  precise float d = limited(norm(apart), w);
  if (d < begin || (d <= begin && begin < end)) return 1.0;
  if (d >= end) return 0.0;
  precise float t = (d - begin) / (end - begin);
  precise float lambda = 1.0 - blend_share(t);
  return lambda;
}

vec3 morph_position(float lambda, vec3 w, vec3 parent) {
  if (lambda >= 1.0) return w;
  if (lambda <= 0.0) return parent;
  precise vec3 n = lambda * w + (1.0 - lambda) * parent;
  return n;
}

float sign_not_zero(float v) { return v < 0.0 ? -1.0 : 1.0; }

vec3 unpack_normal(ivec2 snorm) {
  precise vec2 uv = max(vec2(snorm) / 32767.0, vec2(-1.0));
  precise vec3 n = vec3(uv, 1.0 - abs(uv.x) - abs(uv.y));
  if (n.z < 0.0)
    n.xy = vec2((1.0 - abs(uv.y)) * sign_not_zero(uv.x), (1.0 - abs(uv.x)) * sign_not_zero(uv.y));
  precise float size = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  precise vec3 unit = (1.0 / size) * n;
  return unit;
}

vec3 morph_normal(float lambda, vec3 own, vec3 parent) {
  if (lambda >= 1.0) return own;
  precise vec3 sum = parent;
  if (lambda > 0.0) sum = lambda * own + (1.0 - lambda) * parent;
  precise float norm2 = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
  if (!(norm2 > 1e-12)) return parent;
  precise vec3 unit = (1.0 / sqrt(norm2)) * sum;
  return unit;
}
)";

constexpr const char* vertex_source = R"(
layout(std430, binding = 0) readonly restrict buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly restrict buffer Normals { uint normals[]; };

layout(location = 0) in vec3 own_position;
layout(location = 1) in ivec2 own_normal;
layout(location = 2) in uint parent_index;
layout(location = 3) in uvec4 draw;  // parent's first vertex, level and morphs_bit, first limit, end of the limits

invariant gl_Position;
layout(xfb_buffer = 0, xfb_stride = 12, xfb_offset = 0) out vec3 drawn_position;
centroid out vec3 normal;  // with several samples a pixel, not outside the triangle
flat out vec3 albedo;

void main() {
  uint level = draw.y & 255u;
  precise vec3 p = own_position;
  vec3 n = unpack_normal(own_normal);
#ifdef LIMITED
  limit_range = draw.zw;
#endif
  if (draw.y >= 256u) {
    float lambda = morph_lambda(level, own_position);
    if (lambda < 1.0) {
      uint parent = draw.x + parent_index;
      vec3 parent_position = vec3(positions[3u * parent], positions[3u * parent + 1u], positions[3u * parent + 2u]);
      ivec2 parent_normal = ivec2(int(normals[parent] << 16) >> 16, int(normals[parent]) >> 16);
      p = morph_position(lambda, own_position, parent_position);
      n = morph_normal(lambda, n, unpack_normal(parent_normal));
    }
  }
  drawn_position = p;
  normal = n;
  albedo = frame.levels[level].albedo.rgb;
  precise vec4 clip;
  for (int i = 0; i < 4; ++i) {
    vec4 row = frame.clip_rows[i];
    clip[i] = ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
  }
  gl_Position = clip;
}
)";

// render/shading.h
constexpr const char* fragment_source = R"(
centroid in vec3 normal;
flat in vec3 albedo;
layout(location = 0) out vec4 colour;

void main() {
  float norm2 = dot(normal, normal);
  float cosine = abs(dot(normal, frame.light.xyz)) / sqrt(max(norm2, frame.shading.x));
  colour = vec4(albedo * (frame.light.w + (1.0 - frame.light.w) * min(cosine, 1.0)), 1.0);
}
)";

std::string frame_block_source() { return "#define LEVELS " + std::to_string(max_level + 1) + "\n" + frame_source; }

std::string shader_log(GLuint shader) {
  std::array<GLchar, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  return log.data();
}

std::string program_log(GLuint program) {
  std::array<GLchar, 1024> log{};
  glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  return log.data();
}

// Compiles and attaches; the program keeps the shader alive.
void attach(const GlProgram& program, GLenum stage, const std::string& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  const std::string log = compiled ? "" : shader_log(shader);
  glAttachShader(program.name(), shader);
  glDeleteShader(shader);
  if (!compiled)
    throw UnsupportedError(describe("", "OpenGL", "the driver refuses a shader: " + log, "use --backend soft"));
}

}  // namespace

std::string morph_source(GlVariant variant) {
  return std::string(variant.metric == DistanceMetric::chebyshev ? chebyshev_source : euclidean_source) +
         "float cubic(float t) { precise float s = t * t * (3.0 - 2.0 * t); return s; }\n" +
         share_source(variant.blend) + (variant.limited ? limited_source : unlimited_source) + morph_functions;
}

GlProgram make_draw_program(GlVariant variant) {
  GlProgram program;
  const std::string head =
      version_line + std::string(variant.limited ? "#define LIMITED\n" : "") + frame_block_source();
  attach(program, GL_VERTEX_SHADER, head + morph_source(variant) + vertex_source);
  attach(program, GL_FRAGMENT_SHADER, head + fragment_source);
  glLinkProgram(program.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (!linked)
    throw UnsupportedError(
        describe("", "OpenGL", "the driver refuses a program: " + program_log(program.name()), "use --backend soft"));
  return program;
}

}  // namespace lodestone
