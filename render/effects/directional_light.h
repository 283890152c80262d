// Directional light: strength times max(0, n . l) on the side that faces the eye. Surfaces have two sides: the normal
// is turned to the side of its triangle that is seen, whichever way the triangle and its normals were oriented.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/frame/shading.h"
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo directional_light{
    .effect = Effect::directional_light,
    .what = "light from far away, from one direction",
    .attributes = "",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      const Lighting& l = frame.settings.lighting;
      return l.directional.strength > 0 && l.ambient < 1 ? "a directional light is on" : "";
    },
    .glsl =
        {
            .fragment = R"(
// The normal, turned to the side of its triangle that faces the eye.
vec3 turned_to_eye(vec3 normal) {
  vec3 face = cross(dFdx(drawn_position), dFdy(drawn_position));
  vec4 eye = instances[instance].eye;
  bool flip = (dot(normal, face) < 0.0) != (dot(face, eye.xyz - eye.w * drawn_position) < 0.0);
  return flip ? -normal : normal;
}
void directional_light(inout Surface s) {
  float norm2 = dot(s.normal, s.normal);
  float cosine = dot(turned_to_eye(s.normal), instances[instance].towards_light.xyz) / sqrt(max(norm2, least_norm2));
  s.directional = frame.directional_strength * clamp(cosine, 0.0, 1.0);
  s.light += s.directional;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

// Normals of the triangles, towards the eye, of any length.
inline Points faces_towards_eye(const ShadingJob& job, const Surface& s) {
  const Points face = cross(difference(s.corner[1], s.corner[0]), difference(s.corner[2], s.corner[0]));
  const auto eye = [&](const ModelFrame& m) -> const Eye& { return job.eyes[&m - job.frame->models.data()]; };
  const Float w = of_models(s, [&](const ModelFrame& m) { return eye(m).w; });
  const Points at = vectors_of_models(s, [&](const ModelFrame& m) { return eye(m).at; });
  const Int away = dot(face, difference(at, scaled(w, s.corner[0]))) < 0.0f;
  return select(away, scaled(all(-1.0f), face), face);
}

inline void directional_light(const ShadingJob& job, Surface& s, Int lanes) {
  const Int flip = dot(s.normal, faces_towards_eye(job, s)) < 0.0f;
  const Points to = vectors_of_models(s, [](const ModelFrame& m) { return m.towards_light; });
  const Float along = dot(s.normal, to);
  const Float cosine = select(flip, -along, along) / sqrt(max(dot(s.normal, s.normal), all(shading::least_norm2)));
  const Float strength = all(job.frame->settings.lighting.directional.strength);
  s.directional = as_float(lanes & as_int(strength * min(max(cosine, all(0.0f)), all(1.0f))));
  s.light += s.directional;
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
