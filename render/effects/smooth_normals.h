// Smooth normals: those of the corners, morphed as the corners are, interpolated over the triangle.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo smooth_normals{
    .effect = Effect::smooth_normals,
    .what = "normals interpolated over each triangle",
    .attributes = "normal",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame& m) -> std::string {
      if (!m.appearance.smooth || !is_lit(frame.settings)) return {};
      return "a light falls on a smooth surface";
    },
    .glsl =
        {
            // unpack_normal of core/hierarchy, morph_cell_normals of render/lod/morph.cpp
            .vertex = R"(
layout(location = 1) in ivec2 own_normal;
layout(std430, binding = 1) readonly restrict buffer Normals { uint normals[]; };
centroid out vec3 normal;  // with several samples a pixel, not outside the triangle

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

void smooth_normals() {
  normal = unpack_normal(own_normal);
  if (lambda < 1.0) {
    ivec2 parent_normal = ivec2(int(normals[parent] << 16) >> 16, int(normals[parent]) >> 16);
    normal = morph_normal(lambda, normal, unpack_normal(parent_normal));
  }
}
)",
            .fragment = R"(
centroid in vec3 normal;
void smooth_normals(inout Surface s) {
  if (instance_flag(smooth_flag)) s.normal = normal;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

// unpack_normal, lane by lane.
[[gnu::always_inline]] inline Points unpacked(Int packed) {
  const auto from_snorm16 = [](Int v) { return max(to_float(v) / 32767.0f, all(-1.0f)); };
  const auto with_sign = [](Float v, Float sign) { return select(sign < 0.0f, -v, v); };
  const Float u = from_snorm16((packed << 16) >> 16), v = from_snorm16(packed >> 16);
  const Float z = 1.0f - abs(u) - abs(v);
  const Int below = z < 0.0f;
  const Float x = select(below, with_sign(1.0f - abs(v), u), u), y = select(below, with_sign(1.0f - abs(u), v), v);
  const Float scale = 1.0f / sqrt(x * x + y * y + z * z);
  return {scale * x, scale * y, scale * z};
}

// Morphed as morph_vertex does; of lane k that of vertex vertex_of(k) of cell cell_of(k).
template <class CellOf, class VertexOf>
[[gnu::always_inline]] inline Points morphed_normals(const CellOf& cell_of, const VertexOf& vertex_of, bool morphing) {
  const auto packed = [](const PackedNormal& n) { return std::bit_cast<std::int32_t>(n); };
  const Points n = unpacked(gathered([&](int k) { return packed(cell_of(k).normals[vertex_of(k)]); }));
  if (!morphing) return n;
  const auto coarser = [&](int k) {
    const DrawnCell& cell = cell_of(k);
    return packed(cell.morphing ? cell.coarser_normals[cell.parents[vertex_of(k)]] : cell.normals[vertex_of(k)]);
  };
  const auto lambda = [&](int k) {
    return std::bit_cast<std::int32_t>(cell_of(k).morphing ? cell_of(k).lambdas[vertex_of(k)] : 1.0f);
  };
  const Float l = as_float(gathered(lambda)), rest = 1.0f - l;
  const Int is_own = l >= 1.0f;
  if (bits(is_own) == all_lanes) return n;
  const Points m = unpacked(gathered(coarser));
  const Float x = l * n.x + rest * m.x, y = l * n.y + rest * m.y, z = l * n.z + rest * m.z;
  const Float norm2 = x * x + y * y + z * z;
  const Float scale = 1.0f / sqrt(norm2);
  const Int is_coarser = ~is_own & ((l <= 0.0f) | ~(norm2 > 1e-12f));
  const auto pick = [&](Float a, Float b, Float sum) { return select(is_own, a, select(is_coarser, b, scale * sum)); };
  return {pick(n.x, m.x, x), pick(n.y, m.y, y), pick(n.z, m.z, z)};
}

[[gnu::always_inline]] inline Points corner_normals(const Surface& s, std::size_t i) {
  return morphed_normals([&](int k) -> const DrawnCell& { return *s.cell[k]; }, [&](int k) { return s.v[k][i]; },
                         s.morphing);
}

// If the whole group sees one triangle, its corners share the lanes.
[[gnu::always_inline]] inline Points interpolated_normals(const Surface& s) {
  if (!s.one_triangle) return interpolated(s, corner_normals(s, 0), corner_normals(s, 1), corner_normals(s, 2));
  const Points n = morphed_normals([&](int) -> const DrawnCell& { return *s.cell[0]; },
                                   [&](int k) { return s.v[0][k < 3 ? k : 0]; }, s.morphing);
  const auto corner = [&](int i) { return Points{all(n.x[i]), all(n.y[i]), all(n.z[i])}; };
  return interpolated(s, corner(0), corner(1), corner(2));
}

inline void smooth_normals(const ShadingJob&, Surface& s, Int lanes) {
  const Points n = interpolated_normals(s);
  const Int smooth =
      lanes & (of_models(s, [](const ModelFrame& m) { return m.appearance.smooth ? 1.0f : 0.0f; }) > 0.0f);
  s.normal = bits(smooth) == all_lanes ? n : select(smooth, n, s.normal);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
