#include "render/backends/gl/passes/ambient_occlusion_pass.h"

#include <cstdio>

#include "render/backends/gl/device/program.h"
#include "render/effects/ambient_occlusion.h"

namespace lodestone {
namespace {

// As render/backends/soft/occlusion_kernel.h has it; rows are counted from the top here, too.
constexpr const char* occlusion_body = R"(
layout(binding = 9) uniform sampler2D picture;
layout(binding = 10) uniform sampler2D depths;
layout(location = 0) uniform vec4 lens;       // tan_x, tan_y, near, far
layout(location = 1) uniform vec3 parameters; // strength, radius, density of the fog
layout(location = 0) out vec4 colour;

ivec2 size;
float distance_of(ivec2 at) {
  float depth = texelFetch(depths, ivec2(at.x, size.y - 1 - at.y), 0).r;
  return lens.z * lens.w / (lens.w - depth * (lens.w - lens.z));
}
vec3 place(ivec2 at) {
  float w = distance_of(at);
  return vec3(((vec2(at) + 0.5) * (2.0 / vec2(size)) - 1.0) * lens.xy * w, w);
}
vec3 slope(ivec2 at, vec3 here, ivec2 d) {
  ivec2 from = at - d, to = at + d;
  bool at_begin = from.x < 0 || from.y < 0, at_end = to.x >= size.x || to.y >= size.y;
  vec3 before = place(max(from, ivec2(0))), after = place(min(to, size - 1));
  bool forward = !at_end && (at_begin || abs(after.z - here.z) <= abs(here.z - before.z));
  return forward ? after - here : here - before;
}

void main() {
  size = textureSize(depths, 0);
  ivec2 own = ivec2(gl_FragCoord.xy), at = ivec2(own.x, size.y - 1 - own.y);
  vec4 seen = texelFetch(picture, own, 0);
  colour = vec4(seen.rgb, 1.0);
  if (!(texelFetch(depths, own, 0).r < 1.0)) return;
  vec3 here = place(at);
  float pixels = 0.5 * float(size.y) / lens.y;
  float reach = min(parameters.y * pixels / here.z, REACH * float(size.y));
  if (!(reach >= 1.0)) return;
  float per_radius = pixels / (reach * here.z);
  vec3 n = cross(slope(at, here, ivec2(1, 0)), slope(at, here, ivec2(0, 1)));
  n *= (dot(n, here) > 0.0 ? -1.0 : 1.0) / max(length(n), 1e-30);
  float sum = 0.0;
  for (int k = 0; k < POINTS; ++k) {
    ivec2 q = at + ivec2(roundEven(pattern[k] * reach));
    if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, size))) continue;
    vec3 t = per_radius * (place(q) - here);
    float tt = dot(t, t), near = max(1.0 - tt, 0.0);
    sum += near * near * near * max((dot(t, n) - BIAS) / (tt + EPSILON), 0.0);
  }
  float clear = parameters.z > 0.0 ? exp(-parameters.z * length(here)) : 1.0;
  colour.rgb *= 1.0 - parameters.x * clear * seen.a * min(sum * (5.0 / float(POINTS)), 1.0);
}
)";

std::string number(float v) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9e", static_cast<double>(v));
  return text.data();
}

std::string occlusion_source() {
  std::string points;
  for (const auto& [x, y] : effects::occlusion_pattern())
    points += (points.empty() ? "vec2(" : ", vec2(") + number(x) + ", " + number(y) + ")";
  const std::string count = std::to_string(effects::occlusion_points);
  return "#define POINTS " + count + "\n#define REACH " + number(effects::occlusion_reach) + "\n#define BIAS " +
         number(effects::occlusion_bias) + "\n#define EPSILON " + number(effects::occlusion_epsilon) +
         "\nconst vec2 pattern[" + count + "] = vec2[" + count + "](" + points + ");\n" + occlusion_body;
}

}  // namespace

GlOcclusion::GlOcclusion() : program_(make_screen_program(occlusion_source())) {}

// Each pixel of the picture is read by the one fragment that writes it.
void GlOcclusion::draw(const Frame& frame, const GlTarget& target) {
  const effects::OcclusionJob job = effects::occlusion_job(frame);
  target.bind_result();
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glTextureBarrier();
  glBindTextureUnit(9, target.colour());
  glBindTextureUnit(10, target.depth());
  glUseProgram(program_.name());
  glProgramUniform4f(program_.name(), 0, job.tan_x, job.tan_y, job.near, job.far);
  glProgramUniform3f(program_.name(), 1, job.strength, job.radius, job.fog_density);
  draw_screen(nothing_);
  glBindTextureUnit(9, 0);
  glBindTextureUnit(10, 0);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace lodestone
