// `precise` keeps the operations of map_view.h and resolve_pixel.h as they are written there: equal bits on both
// backends.
#include "render/backends/gl/shaders/map_programs.h"

#include <array>
#include <string>

#include "render/backends/gl/device/program.h"

namespace lodestone {
namespace {

constexpr const char* common_source = R"(
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Triangles { uint triangles[]; };
layout(location = 0) uniform dvec3 eye;
layout(location = 1) uniform dvec3 right;
layout(location = 2) uniform dvec3 up;
layout(location = 3) uniform dvec3 forward;
layout(location = 4) uniform double pixel;
layout(location = 5) uniform ivec2 size;
layout(location = 6) uniform int central;

dvec3 position_of(uint v) {
  return dvec3(double(positions[3 * v]), double(positions[3 * v + 1]), double(positions[3 * v + 2]));
}
double inner(dvec3 a, dvec3 b) {
  precise double sum = (a.x * b.x + a.y * b.y) + a.z * b.z;
  return sum;
}
dvec3 outer(dvec3 a, dvec3 b) {
  precise dvec3 n = dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  return n;
}
)";

constexpr const char* sight_vertex_source = R"(
layout(location = 7) uniform dvec2 depth_range;

double snapped(double v) { return roundEven(clamp(v * 256.0lf, -536870912.0lf, 536870912.0lf)) / 256.0lf; }

void main() {
  precise dvec3 from_eye = position_of(uint(gl_VertexID)) - eye;
  double depth = inner(from_eye, forward);
  precise double spacing = central != 0 ? pixel * depth : pixel;
  precise double scale = 1.0lf / spacing;
  precise double x = 0.5lf * double(size.x) + scale * inner(from_eye, right);
  precise double y = 0.5lf * double(size.y) - scale * inner(from_eye, up);
  double z = central != 0 ? -1.0lf / depth : depth;
  gl_Position = vec4(float(2.0lf * snapped(x) / double(size.x) - 1.0lf), float(2.0lf * snapped(y) / double(size.y) - 1.0lf),
                     float(2.0lf * ((z - depth_range.x) * depth_range.y) - 1.0lf), 1.0);
}
)";

constexpr const char* sight_fragment_source = R"(
layout(location = 0) out uint triangle;
void main() { triangle = uint(gl_PrimitiveID); }
)";

constexpr const char* resolve_fragment_source = R"(
layout(std430, binding = 2) readonly buffer Uv { float uvs[]; };
layout(std430, binding = 3) readonly buffer Colour { uint colours[]; };
layout(location = 8) uniform int channels;
layout(binding = 0) uniform usampler2D seen;
layout(location = 0) out vec4 out_position;
layout(location = 1) out vec4 out_normal;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out uint out_colour;

uint mixed(dvec3 w, uint a, uint b, uint c, int shift) {
  precise double sum = (w.x * double((a >> shift) & 255u) + w.y * double((b >> shift) & 255u)) +
                       w.z * double((c >> shift) & 255u);
  return uint(sum + 0.5lf) << shift;
}

dvec3 corner_weights(dvec3 origin, dvec3 direction, dvec3 a, dvec3 b, dvec3 c) {
  precise dvec3 oa = a - origin, ob = b - origin, oc = c - origin;
  dvec3 w = dvec3(inner(direction, outer(ob, oc)), inner(direction, outer(oc, oa)), inner(direction, outer(oa, ob)));
  precise double turned_sum = (w.x + w.y) + w.z;
  w = max(turned_sum < 0.0lf ? -w : w, dvec3(0.0lf));
  precise double sum = (w.x + w.y) + w.z;
  if (!(sum > 0.0lf)) return dvec3(1.0lf / 3.0lf);
  precise dvec3 share = dvec3(w.x / sum, w.y / sum, w.z / sum);
  return share;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uint t = texelFetch(seen, at, 0).x;
  if (t == 0xFFFFFFFFu) {
    out_position = vec4(0.0), out_normal = vec4(0.0), out_uv = vec2(0.0), out_colour = 0u;
    return;
  }
  precise double u = ((double(at.x) + 0.5lf) - 0.5lf * double(size.x)) * pixel;
  precise double v = (0.5lf * double(size.y) - (double(at.y) + 0.5lf)) * pixel;
  precise dvec3 aside = u * right + v * up;
  precise dvec3 moved = eye + aside;
  precise dvec3 slanted = forward + aside;
  dvec3 origin = central != 0 ? eye : moved, direction = central != 0 ? slanted : forward;

  uint ia = triangles[3 * t], ib = triangles[3 * t + 1], ic = triangles[3 * t + 2];
  dvec3 a = position_of(ia), b = position_of(ib), c = position_of(ic);
  dvec3 w = corner_weights(origin, direction, a, b, c);
  precise dvec3 p = (w.x * a + w.y * b) + w.z * c;
  precise dvec3 from_eye = p - eye;
  out_position = vec4(vec3(p), float(inner(from_eye, forward)));
  precise dvec3 ab = b - a, ac = c - a;
  dvec3 n = outer(ab, ac);
  double norm = sqrt(inner(n, n));
  precise dvec3 unit = (1.0lf / norm) * n;
  out_normal = norm > 0.0lf ? vec4(vec3(unit), 0.0) : vec4(0.0);
  out_uv = vec2(0.0);
  if ((channels & 1) != 0) {
    precise double s = (w.x * double(uvs[2 * ia]) + w.y * double(uvs[2 * ib])) + w.z * double(uvs[2 * ic]);
    precise double r = (w.x * double(uvs[2 * ia + 1]) + w.y * double(uvs[2 * ib + 1])) + w.z * double(uvs[2 * ic + 1]);
    out_uv = vec2(float(s), float(r));
  }
  out_colour = 0u;
  if ((channels & 2) != 0) {
    uint ca = colours[ia], cb = colours[ib], cc = colours[ic];
    out_colour = mixed(w, ca, cb, cc, 0) | mixed(w, ca, cb, cc, 8) | mixed(w, ca, cb, cc, 16) | mixed(w, ca, cb, cc, 24);
  }
}
)";

}  // namespace

GlProgram make_map_sight_program() {
  const std::array<GlStage, 2> stages{GlStage{GL_VERTEX_SHADER, std::string(common_source) + sight_vertex_source},
                                      GlStage{GL_FRAGMENT_SHADER, sight_fragment_source}};
  return link_program(stages);
}

GlProgram make_map_resolve_program() {
  return make_screen_program(std::string(common_source) + resolve_fragment_source);
}

}  // namespace lodestone
