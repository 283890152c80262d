// Shadow of the directional light: a map of depths seen from the light (williams1978) of the same morphed surface,
// looked up with percentage-closer filtering (reeves1987) over 4x4 texels, as the mean of 3x3 bilinear lookups.
//
// Casters that are not opaque hold back what they do not let through: the map has the depth of the first of them, and
// the product of their shares. A point behind the first is behind all of them: between two layers of glass it is as
// dark as behind both. Masked materials cast the shadow of what is there.
//
// Against false shadows a point is moved off its triangle, towards the light, before it is looked up. A plane at an
// angle t to the light needs k sin(t) of that to remain clear of itself k texels sideways: no bias grows without bound.
// Points outside the map are lit. With several samples a pixel a triangle is looked up once in a pixel, as all of its
// light is.
#pragma once

#include <algorithm>

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/effects/directional_light.h"
#endif

namespace lodestone::effects {

// True if a light casts shadows, some model throws one and some model shows it; else there is no pass.
[[nodiscard]] inline bool has_shadow_pass(const Frame& frame) {
  const Lighting& l = frame.settings.lighting;
  if (!frame.effects.contains(Effect::shadow) || !l.directional.shadows) return false;
  if (!(l.directional.strength > 0) || !(l.ambient < 1)) return false;
  const auto casts = [](const ModelFrame& m) {
    return m.casters && std::ranges::any_of(m.casters->cells, &SelectedCell::visible);
  };
  const auto shows = [](const ModelFrame& m) { return m.effects.contains(Effect::directional_light); };
  return std::ranges::any_of(frame.models, casts) && std::ranges::any_of(frame.models, shows);
}

// Maximum number of texels by which a point is moved, and the depth by which it is brought nearer, in depths of a texel
// and absolute.
inline constexpr float shadow_offset = 2.5f, shadow_bias_texels = 0.5f, shadow_bias = 2e-6f;

static_assert(shadow_offset == 2.5f && shadow_bias_texels == 0.5f && shadow_bias == 2e-6f);  // as the GLSL has them

inline constexpr EffectInfo shadow{
    .effect = Effect::shadow,
    .what = "what the directional light does not reach",
    .attributes = "",
    .passes = "depth seen from the light",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      const Lighting& l = frame.settings.lighting;
      return l.directional.shadows && l.directional.strength > 0 && l.ambient < 1
                 ? "the directional light casts shadows"
                 : "";
    },
    .glsl =
        {
            .fragment = R"(
layout(binding = 8) uniform sampler2D shadow_map;
layout(binding = 12) uniform sampler2D shadow_first;  // one texel where all casters are opaque
layout(binding = 13) uniform sampler2D shadow_through;
const float shadow_offset = 2.5, shadow_bias_texels = 0.5, shadow_bias = 2e-6;

// Shares of the light that four texels hold back at the depth p.
vec4 shadow_texels(vec2 at, float p) {
  vec4 hidden = vec4(lessThan(textureGather(shadow_map, at), vec4(p)));
  if (textureSize(shadow_first, 0).x == 1) return hidden;
  vec4 layers = vec4(lessThan(textureGather(shadow_first, at), vec4(p))) * (1.0 - textureGather(shadow_through, at));
  return max(hidden, layers);
}

// Weights of what the texels b - 1 to b + 2 hold back at p, for two rows of them.
float shadow_rows(vec2 corner, float size, float p, vec2 across, vec2 along) {
  vec4 left = shadow_texels(corner / size, p), right = shadow_texels((corner + vec2(2.0, 0.0)) / size, p);
  vec2 lower = left.wz * vec2(across.x, 1.0) + right.wz * vec2(1.0, across.y);
  vec2 upper = left.xy * vec2(across.x, 1.0) + right.xy * vec2(1.0, across.y);
  return along.x * (lower.x + lower.y) + along.y * (upper.x + upper.y);
}

void shadow(inout Surface s) {
  vec3 face = cross(dFdx(drawn_position), dFdy(drawn_position));
  if (!(s.directional > 0.0)) return;
  float size = float(textureSize(shadow_map, 0).x);
  vec4 row_x = instances[instance].light_rows[0], row_y = instances[instance].light_rows[1];
  vec4 row_z = instances[instance].light_rows[2];
  face /= max(length(face), 1e-30);
  float cosine = dot(face, instances[instance].towards_light.xyz);
  float texel = 2.0 / (size * length(row_x.xyz));
  float away = shadow_offset * texel * sqrt(max(1.0 - cosine * cosine, 0.0));
  vec4 p = vec4(drawn_position + (cosine < 0.0 ? -away : away) * face, 1.0);
  vec2 at = (0.5 * vec2(dot(row_x, p), dot(row_y, p)) + 0.5) * size - 0.5;
  float depth = 0.5 + 0.5 * dot(row_z, p) - (shadow_bias + shadow_bias_texels * 0.5 * texel * length(row_z.xyz));
  vec2 base = floor(at), part = at - base, rest = 1.0 - part;
  float hidden = shadow_rows(base, size, depth, vec2(rest.x, part.x), vec2(rest.y, 1.0)) +
                 shadow_rows(base + vec2(0.0, 2.0), size, depth, vec2(rest.x, part.x), vec2(1.0, part.y));
  s.light -= hidden / 9.0 * s.directional;
}
)",
        },
    .of_picture = true,
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

// A row of the models' light projections at p, without its last number or with it.
inline Points light_row(const Surface& s, std::size_t r) {
  const auto m = [&](std::size_t k) {
    return of_models(s, [&](const ModelFrame& f) { return f.light_projection.m[4 * r + k]; });
  };
  return {m(0), m(1), m(2)};
}
inline Float in_light(const Surface& s, const Points& row, std::size_t r, const Points& p) {
  return dot(row, p) + of_models(s, [&](const ModelFrame& f) { return f.light_projection.m[4 * r + 3]; });
}

inline Float floors(Float v) {
  const Float toward_zero = to_float(truncated(v));
  return toward_zero - select(toward_zero > v, all(1.0f), all(0.0f));
}

// The share of the light that 4x4 texels around (u, v) hold back from `depth`, in the lanes of `lanes`.
inline Float hidden_shares(const ShadowView& map, Float u, Float v, Float depth, Int lanes) {
  const float most = static_cast<float>(map.texels) + 2;  // beyond that all texels are those of the border
  u = min(max(u, all(-3.0f)), all(most)), v = min(max(v, all(-3.0f)), all(most));
  const Float base_u = floors(u), base_v = floors(v), part_u = u - base_u, part_v = v - base_v;
  const Int left = truncated(base_u) - 1, top = truncated(base_v) - 1;
  const auto weight = [](int tap, Float part) { return tap == 0 ? 1.0f - part : tap == 3 ? part : all(1.0f); };
  const auto inside = [&](Int i) { return min(max(i, all(0)), all(map.texels - 1)); };
  Float sum = all(0.0f);
  for (int j = 0; j < 4; ++j) {
    const Int row = inside(top + j);
    Float in_row = all(0.0f);
    for (int i = 0; i < 4; ++i) {
      const Int column = inside(left + i);
      const auto stored = [&](const float* plane) {
        return as_float(gathered([&](int k) {
          if (!lanes[k]) return 0;
          const std::size_t at = static_cast<std::size_t>(row[k]) * static_cast<std::size_t>(map.texels) +
                                 static_cast<std::size_t>(column[k]);
          return std::bit_cast<std::int32_t>(plane[at]);
        }));
      };
      Float hidden = select(stored(map.depth) < depth, all(1.0f), all(0.0f));
      if (map.first) hidden = max(hidden, select(stored(map.first) < depth, 1.0f - stored(map.through), all(0.0f)));
      in_row += hidden * weight(i, part_u);
    }
    sum += weight(j, part_v) * in_row;
  }
  return sum / 9.0f;
}

inline void shadow(const ShadingJob& job, Surface& s, Int lanes) {
  lanes &= s.directional > 0.0f;
  if (bits(lanes) == 0) return;
  const ShadowView& map = job.shadow;
  const float size = static_cast<float>(map.texels);
  const Points row_x = light_row(s, 0), row_y = light_row(s, 1), row_z = light_row(s, 2);
  const Points face = cross(difference(s.corner[1], s.corner[0]), difference(s.corner[2], s.corner[0]));
  const Float scale = 1.0f / max(sqrt(dot(face, face)), all(1e-30f));
  const Float cosine = scale * dot(face, vectors_of_models(s, [](const ModelFrame& m) { return m.towards_light; }));
  const Float texel = 2.0f / (size * sqrt(dot(row_x, row_x)));
  const Float away = effects::shadow_offset * texel * sqrt(max(1.0f - cosine * cosine, all(0.0f)));
  const Points offset = scaled(select(cosine < 0.0f, -away, away) * scale, face);
  const Points at = interpolated(s, s.corner[0], s.corner[1], s.corner[2]);
  const Points p{at.x + offset.x, at.y + offset.y, at.z + offset.z};
  const Float u = (0.5f + 0.5f * in_light(s, row_x, 0, p)) * size - 0.5f,
              v = (0.5f - 0.5f * in_light(s, row_y, 1, p)) * size - 0.5f;
  const Float bias = effects::shadow_bias + effects::shadow_bias_texels * 0.5f * texel * sqrt(dot(row_z, row_z));
  const Float depth = (0.5f + 0.5f * in_light(s, row_z, 2, p)) - bias;
  const Float hidden = hidden_shares(map, u, v, depth, lanes);
  s.light = select(lanes, s.light - hidden * s.directional, s.light);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
