// Normal map: the normals of the triangle's material replace those of the surface before any light falls on it.
//
// An object-space map holds them as they are, in the axes of the model. A tangent-space map holds them in the frame of
// the surface: z is its normal, x the direction in which u grows, made perpendicular to the normal, y right-angled to
// both, on the side where v falls (images are stored from the top); the material's scale multiplies x and y. Directions
// of u and v, those of the map if it has a place of its own, are those of the triangle as it is drawn, the same for
// every pixel of it: no tangents are stored (schueler2006). The normal of a flat-shaded surface is the one
// towards the eye.
#pragma once

#include "render/effects/texture_mapping.h"
#include "render/frame/appearance.h"
#include "render/frame/shading.h"

namespace lodestone::effects {

inline constexpr EffectInfo normal_map{
    .effect = Effect::normal_map,
    .what = "normals from an image",
    .attributes = "texture coordinates, material",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame& m) -> std::string {
      if (!m.appearance.normal_maps || !is_lit(frame.settings)) return {};
      return has_normal_maps(*m.morph.hierarchy) ? "a light falls on materials with normal maps" : "";
    },
    .glsl =
        {
            .fragment = R"(
void normal_map(inout Surface s) {
  vec3 along_x = dFdx(drawn_position), along_y = dFdy(drawn_position);
  PlacedMap placed = materials[material].normals;
  if (!instance_flag(normal_maps_flag) || placed.map.x == no_texture) return;
  vec3 mapped = texel_of(placed) * (255.0 / 127.5) - 1.0;
  if (placed.map.w != 0u) {
    s.normal = mapped;
    return;
  }
  mapped.xy *= materials[material].emission.w;
  vec2 t_along_x = turned(placed, uv_along_x), t_along_y = turned(placed, uv_along_y);
  float turn = t_along_x.x * t_along_y.y - t_along_x.y * t_along_y.x < 0.0 ? -1.0 : 1.0;
  vec3 to_u = turn * (t_along_y.y * along_x - t_along_x.y * along_y);
  vec3 to_v = turn * (t_along_x.x * along_y - t_along_y.x * along_x);
  vec3 n = s.normal / sqrt(max(dot(s.normal, s.normal), least_norm2));
  vec3 t = to_u - dot(n, to_u) * n;
  vec3 b = cross(n, t);
  float size2 = dot(t, t);
  if (!(size2 > 0.0)) return;
  if (dot(b, to_v) > 0.0) b = -b;
  float scale = 1.0 / sqrt(size2);
  s.normal = (scale * mapped.x) * t + (scale * mapped.y) * b + mapped.z * n;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

// Normals of the surface, of unit length.
inline Points shading_normals(const Surface& s, const Mapping& m) {
  const Int flat = of_models(s, [](const ModelFrame& f) {
                     return f.appearance.smooth && f.effects.contains(Effect::smooth_normals) ? 0.0f : 1.0f;
                   }) > 0.0f;
  const Points row_w = projection_row(s, 3);
  const Int turned_away = flat & (dot(s.normal, m.away) * dot(row_w, m.away) > 0.0f);
  const Float length2 = max(dot(s.normal, s.normal), all(shading::least_norm2));
  const Float scale = 1.0f / sqrt(length2);
  return scaled(select(turned_away, -scale, scale), s.normal);
}

inline void normal_map(const ShadingJob& job, Surface& s, Int lanes) {
  lanes &= of_models(s, [](const ModelFrame& m) { return m.appearance.normal_maps ? 1.0f : 0.0f; }) > 0.0f;
  if (bits(lanes) == 0) return;
  Materials material;
  find_materials(job, s, material);
  const SurfaceTexture* of_lane[width];
  lanes &= find_textures(
      job, [&](int k) { return material[k]->normal_map; }, bits(lanes), of_lane);
  if (bits(lanes) == 0) return;
  Mapping room;
  const Mapping& m = mapping_of(job, s, material, &SurfaceMaterial::normal_place, room);
  const Points texel = texels(of_lane, m);
  const auto component = [](Float byte) { return byte / 127.5f - 1.0f; };
  const Points mapped{component(texel.x), component(texel.y), component(texel.z)};
  const Int object_space = gathered([&](int k) { return of_lane[k]->object_space ? -1 : 0; });
  // Directions in which u and v grow on the triangle, up to a common positive factor.
  const Int turned = dot(cross(m.along_u, m.along_v), m.normal) < 0.0f;
  const Float sign = select(turned, all(-1.0f), all(1.0f));
  const Points to_u = scaled(sign, cross(m.along_v, m.normal)), to_v = scaled(sign, cross(m.normal, m.along_u));
  const Points n = shading_normals(s, m), t = difference(to_u, scaled(dot(n, to_u), n)), b = cross(n, t);
  const Float size2 = dot(t, t), scale = 1.0f / sqrt(size2);
  const Float bend = scale * of_materials(material, [](const SurfaceMaterial& of) { return of.normal_scale; });
  const Float x = bend * mapped.x, y = select(dot(b, to_v) > 0.0f, -bend, bend) * mapped.y;
  const Points bent{x * t.x + y * b.x + mapped.z * n.x, x * t.y + y * b.y + mapped.z * n.y,
                    x * t.z + y * b.z + mapped.z * n.z};
  s.normal = select(lanes & ~object_space & (size2 > 0.0f), bent, s.normal);
  s.normal = select(lanes & object_space, mapped, s.normal);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
