// Texture coordinates of a surface, and lookups there: shared by all effects of materials. Maps other than that of the
// base colour may have a place of their own on them (KHR_texture_transform).
//
// Texture coordinates morph as positions do. The differences of u and v between a pixel and its neighbours tell how
// much of a texture it covers, and with that the level of detail:
//
//     lod = log2 max(|d(u width, v height)/dx|, |d(u width, v height)/dy|),  at least 0
//
// with the logarithm linear between powers of four (blinn1997: the bits of a float, read as an integer): at most 0.043
// off, and the same everywhere. Between texels, and between the two nearest levels, colours are interpolated linearly
// (williams1983).
//
// `gl` takes the differences of neighbouring pixels. `soft` derives them from the triangle: the ray through a
// neighbouring pixel meets its plane at a place that is linear in the weights of the corners.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "core/hierarchy/model/material_of.h"
#include "render/surface/surface.h"
#include "render/textures/surface_textures.h"
#endif

namespace lodestone::effects {

// Declared before either of the others.
inline constexpr std::string_view material_source = R"(
// A texture: its first level, how many more there are, wrap modes, is it in object space.
struct PlacedMap {
  uvec4 map;
  vec4 turn;  // two rows
  vec4 move;  // x and y
};
struct Material {
  vec4 base_colour;  // and alpha
  uvec4 colours;
  PlacedMap normals, occlusion, emission_map;
  vec4 emission;  // and scale of the normal map
  vec4 factors;   // strength of the occlusion, cutoff of alpha
  uvec4 flags;    // alpha mode, seen from one side, unlit
};
layout(std430, binding = 6) readonly restrict buffer Materials { Material materials[]; };
)";

inline constexpr std::string_view mapping_vertex = R"(
layout(location = 4) in vec2 own_uv;
layout(location = 6) in uint own_material;
layout(std430, binding = 4) readonly restrict buffer TextureCoordinates { float uvs[]; };
centroid out vec2 uv;  // with several samples a pixel, not outside the triangle
out vec2 centre_uv;
flat out uint material;

void map_texture() {
  uv = own_uv;
  if (lambda < 1.0 && instance_flag(has_uv_flag)) {
    vec2 parent_uv = vec2(uvs[2u * parent], uvs[2u * parent + 1u]);
    uv = lambda > 0.0 ? lambda * own_uv + (1.0 - lambda) * parent_uv : parent_uv;
  }
  centre_uv = uv;
  uvec4 of_model = instances[instance].flags;
  material = of_model.y + (instance_flag(has_materials_flag) ? own_material + 1u : of_model.z);
}
)";

inline constexpr std::string_view mapping_fragment = R"(
centroid in vec2 uv;
in vec2 centre_uv;
flat in uint material;

struct TextureLevel {
  vec4 place;  // origin and size in its page, texels
  vec4 page;   // its number, 1 / width and height of all pages
};
layout(std430, binding = 7) readonly restrict buffer TextureLevels { TextureLevel texture_levels[]; };
layout(binding = 4) uniform sampler2DArray texture_pages;

vec2 uv_along_x, uv_along_y;  // differences between neighbouring pixels
void map_texture() {
  uv_along_x = dFdx(centre_uv);
  uv_along_y = dFdy(centre_uv);
}

float wrapped(float t, uint mode) {
  if (mode == 1u) return clamp(t, 0.0, 1.0);
  if (mode == 0u) return t - floor(t);
  t -= 2.0 * floor(0.5 * t);
  return t > 1.0 ? 2.0 - t : t;
}

vec4 texel(uint level, vec2 at) {
  TextureLevel l = texture_levels[level];
  return textureLod(texture_pages, vec3((l.place.xy + at * l.place.zw) * l.page.yz, l.page.x), 0.0);
}

vec4 texel_at(uvec4 map, vec2 t, vec2 t_along_x, vec2 t_along_y) {
  vec2 size = texture_levels[map.x].place.zw, along_x = t_along_x * size, along_y = t_along_y * size;
  float extent2 = max(max(dot(along_x, along_x), dot(along_y, along_y)), 1.0);
  float lod = float(floatBitsToInt(extent2) - 0x3f800000) * (0.5 / 8388608.0);
  lod = min(lod, float(map.y));
  uint level = uint(lod);
  float share = lod - float(level);
  vec2 at = vec2(wrapped(t.x, map.z & 3u), wrapped(t.y, map.z >> 2));
  vec4 finer = texel(map.x + level, at);
  return share > 0.0 ? mix(finer, texel(map.x + level + 1u, at), share) : finer;
}
vec4 texel_and_alpha_of(uvec4 map) { return texel_at(map, uv, uv_along_x, uv_along_y); }
vec3 texel_of(uvec4 map) { return texel_and_alpha_of(map).rgb; }
vec2 turned(PlacedMap m, vec2 t) { return vec2(dot(m.turn.xy, t), dot(m.turn.zw, t)); }
vec3 texel_of(PlacedMap m) {
  return texel_at(m.map, turned(m, uv) + m.move.xy, turned(m, uv_along_x), turned(m, uv_along_y)).rgb;
}
)";

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

// Materials of the lanes.
using Materials = const SurfaceMaterial* [width];
inline void find_materials(const ShadingJob& job, const Surface& s, Materials& to) {
  for (int k = 0; k < width; ++k) {
    const DrawnCell& cell = *s.cell[k];
    const std::span<const SurfaceMaterial> of_model = job.textures->materials(cell.model->model);
    to[k] = &of_model[material_of(*cell.model->morph.hierarchy, *cell.own, s.v[k][0]) + std::uint32_t{1}];
  }
}

// Lanes whose model shows its materials.
inline Int shows_materials(const Surface& s) {
  return of_models(s, [](const ModelFrame& m) { return m.appearance.textures ? 1.0f : 0.0f; }) > 0.0f;
}

struct Coordinates {
  Float u, v;
};

// Texture coordinates, morphed as morph_vertex does: in lane k those of vertex vertex_of(k) of cell cell_of(k). Zero if
// a model has none.
template <class CellOf, class VertexOf>
[[gnu::always_inline]] inline Coordinates morphed_coordinates(const CellOf& cell_of, const VertexOf& vertex_of,
                                                              bool morphing) {
  static constexpr Vec2f none{};
  const float *own[width], *parent[width];
  for (int k = 0; k < width; ++k) {
    const DrawnCell& cell = cell_of(k);
    const std::uint32_t vertex = vertex_of(k);
    own[k] = cell.uv ? &cell.uv[vertex].x : &none.x;
    parent[k] = cell.coarser_uv ? &cell.coarser_uv[cell.parents[vertex]].x : own[k];
  }
  const auto q = load_pairs([&](int k) { return own[k]; }, [&](int k) { return parent[k]; });
  if (!morphing) return {q.a, q.b};
  const Float lambda = morphed_lambdas(cell_of, vertex_of), rest = 1.0f - lambda;
  const Int is_own = lambda >= 1.0f, is_coarser = lambda <= 0.0f;
  const auto mix = [&](Float a, Float b) { return select(is_own, a, select(is_coarser, b, lambda * a + rest * b)); };
  return {mix(q.a, q.c), mix(q.b, q.d)};
}

// Coordinates of the three corners, which share the lanes if the whole group sees one triangle.
inline std::array<Coordinates, 3> corner_coordinates(const Surface& s) {
  std::array<Coordinates, 3> corner;
  if (!s.one_triangle) {
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = morphed_coordinates([&](int k) -> const DrawnCell& { return *s.cell[k]; },
                                      [&](int k) { return s.v[k][i]; }, s.morphing);
    return corner;
  }
  const Coordinates c = morphed_coordinates([&](int) -> const DrawnCell& { return *s.cell[0]; },
                                            [&](int k) { return s.v[0][k < 3 ? k : 0]; }, s.morphing);
  for (std::size_t i = 0; i < 3; ++i) corner[i] = {all(c.u[i]), all(c.v[i])};
  return corner;
}

// The view projection's row r of each lane's model.
[[gnu::always_inline]] inline Points projection_row(const Surface& s, std::size_t r) {
  return {of_models(s, [&](const ModelFrame& m) { return m.view_projection.m[4 * r]; }),
          of_models(s, [&](const ModelFrame& m) { return m.view_projection.m[4 * r + 1]; }),
          of_models(s, [&](const ModelFrame& m) { return m.view_projection.m[4 * r + 2]; })};
}

inline Mapping find_mapping(const ShadingJob& job, Surface& s) {
  const auto [ta, tb, tc] = corner_coordinates(s);
  if (!s.has_corners) find_corners(s);
  const Points a = s.corner[0], to_b = difference(s.corner[1], a), to_c = difference(s.corner[2], a);
  Mapping m;
  m.u = interpolated(s, ta.u, tb.u, tc.u), m.v = interpolated(s, ta.v, tb.v, tc.v);
  // Gradients of the weights of b and c are in the plane and right-angled to the edge on which they vanish.
  m.normal = cross(to_b, to_c);
  const Float scale = 1.0f / dot(m.normal, m.normal);
  const Points of_b = scaled(scale, cross(to_c, m.normal)), of_c = scaled(scale, cross(m.normal, to_b));
  const auto gradient = [&](Float b, Float c) -> Points {
    return {b * of_b.x + c * of_c.x, b * of_b.y + c * of_c.y, b * of_b.z + c * of_c.z};
  };
  m.along_u = gradient(tb.u - ta.u, tc.u - ta.u), m.along_v = gradient(tb.v - ta.v, tc.v - ta.v);
  // A pixel's step d on the plane: row_x d = w 2 / width, row_y d = 0, with the rows of clip x and y minus that of clip
  // w times the pixel's window coordinates.
  const Points row_w = projection_row(s, 3), row_0 = projection_row(s, 0), row_1 = projection_row(s, 1);
  const Float at_x = to_float(s.x) / job.half_width - 1.0f, at_y = 1.0f - to_float(s.y) / job.half_height;
  const Points row_x = difference(row_0, scaled(at_x, row_w)), row_y = difference(row_1, scaled(at_y, row_w));
  const Points here{a.x + s.weight[1] * to_b.x + s.weight[2] * to_c.x,
                    a.y + s.weight[1] * to_b.y + s.weight[2] * to_c.y,
                    a.z + s.weight[1] * to_b.z + s.weight[2] * to_c.z};
  const Float w = dot(row_w, here) + of_models(s, [](const ModelFrame& f) { return f.view_projection.m[15]; });
  m.away = cross(row_x, row_y);
  const Points side = cross(row_y, m.normal), up = cross(m.normal, row_x);
  const Float step = w * static_cast<float>(subpixels) / dot(row_x, side);
  const Float step_x = step / job.half_width, step_y = -step / job.half_height;
  m.u_x = step_x * dot(m.along_u, side), m.v_x = step_x * dot(m.along_v, side);
  m.u_y = step_y * dot(m.along_u, up), m.v_y = step_y * dot(m.along_v, up);
  return m;
}

// t - floor(t); 0 for numbers so large that they have no fraction, and for NaN.
inline Float fraction(Float t) {
  constexpr float large = 8388608;
  t = min(max(t, all(-large)), all(large));
  const Float whole = to_float(truncated(t));
  return t - (whole + as_float((whole > t) & as_int(all(-1.0f))));
}

inline Float wrapped(Float t, Int mode) {
  const Int mirror = mode == static_cast<std::int32_t>(TextureWrap::mirror),
            clamp = mode == static_cast<std::int32_t>(TextureWrap::clamp);
  Float r = fraction(t);
  if (bits(clamp) != 0) r = select(clamp, min(max(t, all(0.0f)), all(1.0f)), r);
  if (bits(mirror) != 0) {
    const Float twice = 2.0f * fraction(0.5f * t);
    r = select(mirror, min(twice, 2.0f - twice), r);
  }
  return r;
}

template <class Thing>
inline bool all_equal(const Thing* const (&of)[width]) {
  bool equal = true;
  for (int k = 1; k < width; ++k) equal &= of[k] == of[0];
  return equal;
}

// A number of each lane's thing, or, if all lanes have the same thing, of one for all.
template <class Thing>
struct LaneThings {
  const Thing* const (&of)[width];
  bool same;

  template <class Number>
  [[gnu::always_inline]] Int operator()(const Number& number) const {
    if (same) return all(static_cast<std::int32_t>(number(*of[0])));
    return gathered([&](int k) { return static_cast<std::int32_t>(number(*of[k])); });
  }
};

// A number of each lane's material, and three of them.
template <class Of>
[[gnu::always_inline]] inline Float of_materials(const Materials& material, const Of& of) {
  const LaneThings<SurfaceMaterial> number{material, all_equal(material)};
  return as_float(
      number([&](const SurfaceMaterial& m) { return std::bit_cast<std::int32_t>(static_cast<float>(of(m))); }));
}
template <class Of>
[[gnu::always_inline]] inline Points vectors_of_materials(const Materials& material, const Of& of) {
  return {of_materials(material, [&](const SurfaceMaterial& m) { return of(m).x; }),
          of_materials(material, [&](const SurfaceMaterial& m) { return of(m).y; }),
          of_materials(material, [&](const SurfaceMaterial& m) { return of(m).z; })};
}

// Channels of a level of each lane at (u, v) in [0, 1], 0 to 255, from bit `First` of a texel on. Levels have a border,
// so that every texel has neighbours.
template <int First, std::size_t Count>
[[gnu::always_inline]] inline std::array<Float, Count> bilinear(const MipLevel* const (&level)[width], bool same,
                                                                Float u, Float v) {
  const LaneThings<MipLevel> number{level, same};
  const Float x = u * to_float(number([](const MipLevel&l) { return l.size.width; })) + 0.5f,
              y = v * to_float(number([](const MipLevel&l) { return l.size.height; })) + 0.5f;
  const Int column = truncated(x), row = truncated(y), stride = number([](const MipLevel&l) { return l.stride(); });
  std::int32_t above[width], below[width];
  store(above, wrapping_product(row, stride) + column);
  store(below, load<Int>(above) + stride);
  const auto q = load_pairs([&](int k) { return level[k]->texels.data() + above[k]; },
                            [&](int k) { return level[k]->texels.data() + below[k]; });
  const Int a = as_int(q.a), b = as_int(q.b), c = as_int(q.c), d = as_int(q.d);
  const Float along = x - to_float(column), down = y - to_float(row);
  const auto channel = [&](int shift) {
    const auto byte = [&](Int texel) { return to_float((texel >> shift) & 255); };
    const Float upper = byte(a) + along * (byte(b) - byte(a)), lower = byte(c) + along * (byte(d) - byte(c));
    return upper + down * (lower - upper);
  };
  std::array<Float, Count> channels;
  for (std::size_t k = 0; k < Count; ++k) channels[k] = channel(First + 8 * static_cast<int>(k));
  return channels;
}

// Computed once for all effects of a pixel that ask for it.
inline const Mapping& mapping_of(const ShadingJob& job, Surface& s) {
  if (!s.is_mapped) s.mapping = find_mapping(job, s);
  s.is_mapped = true;
  return s.mapping;
}

// The mapping of maps that have a place of their own; computed into `room` where any has.
inline const Mapping& mapping_of(const ShadingJob& job, Surface& s, const Materials& material,
                                 MapPlace SurfaceMaterial::*place, Mapping& room) {
  const Mapping& m = mapping_of(job, s);
  if (!job.textures->moves_maps()) return m;
  const auto number = [&](float MapPlace::*n) {
    return of_materials(material, [&](const SurfaceMaterial& of) { return of.*place.*n; });
  };
  const Float a = number(&MapPlace::a), b = number(&MapPlace::b), c = number(&MapPlace::c), d = number(&MapPlace::d);
  room = m;
  room.u = a * m.u + b * m.v + number(&MapPlace::x), room.v = c * m.u + d * m.v + number(&MapPlace::y);
  room.u_x = a * m.u_x + b * m.v_x, room.v_x = c * m.u_x + d * m.v_x;
  room.u_y = a * m.u_y + b * m.v_y, room.v_y = c * m.u_y + d * m.v_y;
  const auto sum = [](Float k, Points p, Float n, Points q) -> Points {
    return {k * p.x + n * q.x, k * p.y + n * q.y, k * p.z + n * q.z};
  };
  room.along_u = sum(a, m.along_u, b, m.along_v), room.along_v = sum(c, m.along_u, d, m.along_v);
  return room;
}

// Textures of the lanes, by number_of(lane), which may be no_texture; returns the lanes that have one. The other lanes,
// and those not asked for, repeat one of these.
template <class NumberOf>
inline Int find_textures(const ShadingJob& job, const NumberOf& number_of, unsigned asked,
                         const SurfaceTexture* (&to)[width]) {
  std::int32_t there[width]{};
  const SurfaceTexture* any = nullptr;
  for (int k = 0; k < width; ++k) {
    const std::uint32_t number = asked >> k & 1 ? number_of(k) : no_texture;
    to[k] = number == no_texture ? nullptr : &job.textures->textures()[number];
    there[k] = to[k] ? -1 : 0;
    if (to[k]) any = to[k];
  }
  for (const SurfaceTexture*& t : to)
    if (!t) t = any;
  return load<Int>(there);
}

// Channels of each lane's texture, 0 to 255, from bit `First` of a texel on. All lanes have one.
template <int First, std::size_t Count>
[[gnu::always_inline]] inline std::array<Float, Count> sampled(const SurfaceTexture* const (&texture)[width],
                                                               const Mapping& m) {
  bool same = all_equal(texture);
  const LaneThings<SurfaceTexture> number{texture, same};
  const Float across = to_float(number([](const SurfaceTexture&t) { return t.levels.front().size.width; })),
              down = to_float(number([](const SurfaceTexture&t) { return t.levels.front().size.height; }));
  const auto square = [](Float x, Float y) { return x * x + y * y; };
  const Float extent2 = max(max(square(m.u_x * across, m.v_x * down), square(m.u_y * across, m.v_y * down)), all(1.0f));
  Float lod = to_float(as_int(extent2) - 0x3f80'0000) * (0.5f / 8388608);
  lod = min(lod, to_float(number([](const SurfaceTexture& t) { return t.levels.size() - 1; })));
  const Float u = wrapped(m.u, number([](const SurfaceTexture&t) { return t.wrap_u; })),
              v = wrapped(m.v, number([](const SurfaceTexture&t) { return t.wrap_v; }));
  const Int finer = truncated(lod), between = lod > to_float(finer);
  const MipLevel* level[width];
  std::int32_t finer_of[width], next_of[width];
  store(finer_of, finer);
  store(next_of, between & 1);
  for (int k = 0; k < width; ++k) level[k] = texture[k]->levels.data() + finer_of[k];
  same &= bits(finer == finer_of[0]) == all_lanes;
  const std::array<Float, Count> near = bilinear<First, Count>(level, same, u, v);
  if (bits(between) == 0) return near;
  for (int k = 0; k < width; ++k) level[k] += next_of[k];
  const std::array<Float, Count> far = bilinear<First, Count>(level, same && bits(between) == all_lanes, u, v);
  const Float share = lod - to_float(finer);
  std::array<Float, Count> mixed;
  for (std::size_t c = 0; c < Count; ++c) mixed[c] = near[c] + share * (far[c] - near[c]);
  return mixed;
}

inline Points texels(const SurfaceTexture* const (&texture)[width], const Mapping& m) {
  const auto [red, green, blue] = sampled<0, 3>(texture, m);
  return {red, green, blue};
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
