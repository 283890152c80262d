// Wireframe: the edges of the drawn triangles, morphed, as lines of constant width in pixels (baerentzen2006), before
// fog. A line is drawn by the triangles at its sides, each on its visible part: a pixel's share is 1 up to
// shading::wire_half_width - 1/2 from the nearest edge of its own triangle, and falls to 0 within a pixel. Distances
// are those of the pixel's centre, with several samples, too.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/frame/shading.h"
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo wireframe{
    .effect = Effect::wireframe,
    .what = "edges of the triangles",
    .attributes = "",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      return frame.settings.wireframe > 0 ? "edges are asked for" : "";
    },
    .glsl =
        {
            // A point of each edge in the window, and the edge's direction. The part in front of the near plane is cut
            // off.
            .geometry = R"(
flat out vec4 wire_ab;
flat out vec4 wire_bc;
flat out vec4 wire_ca;

vec2 wire_window(vec4 clip) { return (0.5 * clip.xy / clip.w + 0.5) * frame.size; }

vec4 wire_line(vec4 p, vec4 q) {
  float at_p = p.z + p.w, at_q = q.z + q.w;
  if (at_p < 0.0 && at_q < 0.0) return vec4(-1e6, 0.0, 0.0, 1.0);  // not seen
  if (at_p < 0.0) p = q + (at_q / (at_q - at_p)) * (p - q);
  if (at_q < 0.0) q = p + (at_p / (at_p - at_q)) * (q - p);
  vec2 from = wire_window(p), along = wire_window(q) - from;
  return vec4(from, along / max(length(along), 1e-6));
}

void wireframe() {
  wire_ab = wire_line(gl_in[0].gl_Position, gl_in[1].gl_Position);
  wire_bc = wire_line(gl_in[1].gl_Position, gl_in[2].gl_Position);
  wire_ca = wire_line(gl_in[2].gl_Position, gl_in[0].gl_Position);
}
)",
            .fragment = R"(
flat in vec4 wire_ab;
flat in vec4 wire_bc;
flat in vec4 wire_ca;

float wire_distance(vec4 line) {
  vec2 apart = gl_FragCoord.xy - line.xy;
  return abs(line.z * apart.y - line.w * apart.x);
}

void wireframe(inout Surface s) {
  if (!(frame.wireframe > 0.0)) return;
  float nearest = min(min(wire_distance(wire_ab), wire_distance(wire_bc)), wire_distance(wire_ca));
  float share = frame.wireframe * clamp(wire_half_width + 0.5 - nearest, 0.0, 1.0);
  s.colour = (1.0 - share) * s.colour + share * wire_colour;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

struct ClipPoints {
  Float x, y, z, w;
};
inline ClipPoints in_clip_space(const Surface& s, const Points& p) {
  const auto row = [&](std::size_t r) {
    const auto m = [&](std::size_t k) {
      return of_models(s, [&](const ModelFrame& f) { return f.view_projection.m[4 * r + k]; });
    };
    return ((m(0) * p.x + m(1) * p.y) + m(2) * p.z) + m(3);
  };
  return {row(0), row(1), row(2), row(3)};
}

// Distances in pixels from (x, y) to the line through two points; see the GLSL.
inline Float edge_distances(const ShadingJob& job, ClipPoints p, ClipPoints q, Float x, Float y) {
  const auto moved = [](Int out, ClipPoints& to, const ClipPoints& from, Float t) {
    const auto move = [&](Float& a, Float b) { a = select(out, b + t * (a - b), a); };
    move(to.x, from.x), move(to.y, from.y), move(to.w, from.w);
  };
  const Float at_p = p.z + p.w, at_q = q.z + q.w;
  const Int p_out = at_p < 0.0f, q_out = at_q < 0.0f;
  if (bits(p_out | q_out)) {
    moved(p_out & ~q_out, p, q, at_q / (at_q - at_p));
    moved(q_out & ~p_out, q, p, at_p / (at_p - at_q));
  }
  constexpr float pixel = 1.0f / subpixels;
  const float half_width = job.half_width * pixel, half_height = job.half_height * pixel;
  const auto window_x = [&](const ClipPoints& c) { return (1.0f + c.x / c.w) * half_width; };
  const auto window_y = [&](const ClipPoints& c) { return (1.0f - c.y / c.w) * half_height; };
  const Float from_x = window_x(p), from_y = window_y(p), along_x = window_x(q) - from_x,
              along_y = window_y(q) - from_y;
  const Float length = max(sqrt(along_x * along_x + along_y * along_y), all(1e-6f));
  const Float apart = abs((along_x / length) * (y - from_y) - (along_y / length) * (x - from_x));
  return select(p_out & q_out, all(1e6f), apart);
}

inline void wireframe(const ShadingJob& job, Surface& s, Int lanes) {
  const float opacity = job.frame->settings.wireframe;
  if (!(opacity > 0)) return;
  const ClipPoints a = in_clip_space(s, s.corner[0]), b = in_clip_space(s, s.corner[1]),
                   c = in_clip_space(s, s.corner[2]);
  const auto centre = [](Int subpixel) { return to_float(subpixel >> subpixel_bits) + 0.5f; };
  const Float x = centre(s.x), y = centre(s.y);
  const Float nearest =
      min(min(edge_distances(job, a, b, x, y), edge_distances(job, b, c, x, y)), edge_distances(job, c, a, x, y));
  const Float share = opacity * min(max(shading::wire_half_width + 0.5f - nearest, all(0.0f)), all(1.0f));
  const auto mix = [&](Float own, float wire) { return select(lanes, (1.0f - share) * own + share * wire, own); };
  const Vec3f wire = shading::wire_colour;
  s.colour = {mix(s.colour.x, wire.x), mix(s.colour.y, wire.y), mix(s.colour.z, wire.z)};
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
