#include "core/spherical/resample/surface_source.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/error.h"
#include "core/math/lanes/float4x3.h"
#include "core/mesh/vertex_of.h"
#include "core/texture/colour.h"

namespace lodestone::spherical {
namespace {

constexpr Triangle no_corners{{no_source, no_source, no_source}};

Vec3f unit_or_zero(Vec3f v) {
  const float size = length(v);
  return size > 0 ? (1 / size) * v : Vec3f{};
}

// A normal of tangent space: x is the direction in which u grows, made perpendicular to the normal, y is on the side
// where v falls.
Vec3f bent(Vec3f to_u, Vec3f to_v, Vec3f normal, Vec3f mapped) {
  const Vec3f t = unit_or_zero(to_u - dot(normal, to_u) * normal);
  if (t == Vec3f{}) return normal;
  const Vec3f b = cross(normal, t);
  return (mapped.x * t + (dot(b, to_v) > 0 ? -mapped.y : mapped.y) * b) + mapped.z * normal;
}

// Both in lanes.
Float4x3 unit_or_zero(const Float4x3& v) {
  const Float4 size = sqrt(dot(v, v));
  return select(size > all4(0), all4(1) / size, all4(0)) * v;
}
Float4x3 bent(const Float4x3& to_u, const Float4x3& to_v, const Float4x3& normal, const Float4x3& mapped) {
  const Float4x3 along = to_u - dot(normal, to_u) * normal;
  const Float4 size = sqrt(dot(along, along));
  const Float4x3 t = (all4(1) / size) * along, b = cross(normal, t);
  const Float4 y = select(dot(b, to_v) > all4(0), -mapped.y, mapped.y);
  return select(size > all4(0), (mapped.x * t + y * b) + mapped.z * normal, normal);
}

template <class Value>
Value mixed(const std::vector<Value>& values, const Triangle& corners, const std::array<float, 3>& weight) {
  return weight[0] * values[corners.v[0]] + weight[1] * values[corners.v[1]] + weight[2] * values[corners.v[2]];
}

[[noreturn]] void refuse_corners(std::size_t triangle) {
  throw InputError(describe("", "surface",
                            "triangle " + std::to_string(triangle) + " has other corners than its source",
                            "give the mesh that it was made from"));
}

}  // namespace

SurfaceSource::SurfaceSource(std::shared_ptr<const MeshSource> source, const Surface& surface,
                             std::span<const Vec3d> directions)
    : source_(std::move(source)), mesh_(source_->mesh()) {
  match_corners(surface);
  add_coordinates(surface, directions);
}

void SurfaceSource::add_coordinates(const Surface& surface, std::span<const Vec3d> directions) {
  if (mesh_.wedges.uv.empty()) return;
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    if (corners_[t] == no_corners) continue;
    const auto [a, b, c] = surface.triangles[t].v;
    const double area = length(cross(directions[b] - directions[a], directions[c] - directions[a]));
    const auto& [i, j, k] = corners_[t].v;
    Vec2f p = source_->uv(i), q = source_->uv(j), r = source_->uv(k);
    if (const auto part = parts_.find(static_cast<std::uint32_t>(t)); part != parts_.end()) {
      const auto at = [&](const std::array<float, 3>& w) {
        return Vec2f{w[0] * p.x + w[1] * q.x + w[2] * r.x, w[0] * p.y + w[1] * q.y + w[2] * r.y};
      };
      std::tie(p, q, r) = std::tuple(at(part->second[0]), at(part->second[1]), at(part->second[2]));
    }
    Patch& patch = patches_[t];
    patch.uv = p, patch.to_b = {q.x - p.x, q.y - p.y}, patch.to_c = {r.x - p.x, r.y - p.y};
    const double mapped = double{patch.to_b.x} * patch.to_c.y - double{patch.to_c.x} * patch.to_b.y;
    if (area > 0) patch.uv_scale = static_cast<float>(std::sqrt(std::abs(mapped) / area));
    if (source_->shade(patch.shade).normal_map != no_texture) set_frame(static_cast<std::uint32_t>(t));
  }
}

// Corners of a triangle of the surface are those of its source, beginning with any of them.
void SurfaceSource::match_corners(const Surface& surface) {
  corners_.assign(surface.triangles.size(), no_corners);
  patches_.resize(corners_.size());
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    const std::uint32_t source = surface.source_triangle[t];
    if (source == no_source) continue;
    const auto& wedges = mesh_.triangles[source].v;
    const auto& v = surface.triangles[t].v;
    const auto fits = [&](std::size_t turn) {
      for (std::size_t k = 0; k < 3; ++k)
        if (vertex_of(mesh_, wedges[(k + turn) % 3]) != vertex_of(mesh_, surface.source_vertex[v[k]].a)) return false;
      return true;
    };
    std::size_t turn = 0;
    if (std::ranges::all_of(v, [&](std::uint32_t corner) { return surface.source_vertex[corner].is_vertex(); }))
      while (turn < 3 && !fits(turn)) ++turn;
    else
      turn = 3;
    if (turn == 3) match_part(surface, static_cast<std::uint32_t>(t));
    turn %= 3;
    corners_[t] = {{wedges[turn], wedges[(turn + 1) % 3], wedges[(turn + 2) % 3]}};
    patches_[t].chart = source_->chart(wedges[turn]);
    patches_[t].shade = source_->shade_number(wedges[turn]);
  }
}

// A triangle that was turned over has its corners in the other order; where an edge was halved (topology/manifold.h) it
// is a part of its source, with the middles of sides and its own for corners.
void SurfaceSource::match_part(const Surface& surface, std::uint32_t triangle) {
  const auto& wedges = mesh_.triangles[surface.source_triangle[triangle]].v;
  CornerWeights& corners = parts_[triangle];
  patches_[triangle].is_part = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const SourceVertex vertex = surface.source_vertex[surface.triangles[triangle].v[k]];
    if (vertex == no_source) {
      corners[k] = {1.0f / 3, 1.0f / 3, 1.0f / 3};
      continue;
    }
    const auto weight_of = [&](std::uint32_t wedge, std::uint32_t end) {
      return vertex_of(mesh_, wedge) == vertex_of(mesh_, end) ? 0.5f : 0.0f;
    };
    for (std::size_t i = 0; i < 3; ++i) corners[k][i] = weight_of(wedges[i], vertex.a) + weight_of(wedges[i], vertex.b);
    if (corners[k][0] + corners[k][1] + corners[k][2] != 1) refuse_corners(triangle);
  }
}

std::array<float, 3> SurfaceSource::weights(const SurfacePoint& point) const {
  if (patches_[point.triangle].is_part == 0) return point.weight;
  const CornerWeights& corners = parts_.at(point.triangle);
  std::array<float, 3> sum{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) sum[i] += point.weight[k] * corners[k][i];
  return sum;
}

SurfaceSource::Patch4 SurfaceSource::patches(const std::array<std::uint32_t, 4>& triangles) const {
  std::array<Float4, 4> first, rest;
  for (std::size_t k = 0; k < 4; ++k) {
    const Patch& patch = patches_[triangles[k]];
    first[k] = Float4{patch.uv.x, patch.uv.y, patch.to_b.x, patch.to_b.y};
    rest[k] = Float4{patch.to_c.x, patch.to_c.y, 0, 0};
  }
  const Quads<Float4> f = transposed(first[0], first[1], first[2], first[3]),
                      r = transposed(rest[0], rest[1], rest[2], rest[3]);
  return {{f.a, f.b}, {f.c, f.d}, {r.a, r.b}};
}

SurfaceSource::Coordinates4 SurfaceSource::along(const Patch4& patch, const Weights4& weight) {
  return {weight.b * patch.to_b.u + weight.c * patch.to_c.u, weight.b * patch.to_b.v + weight.c * patch.to_c.v};
}

SurfaceSource::Coordinates4 SurfaceSource::uv(const std::array<std::uint32_t, 4>& triangles,
                                              const Weights4& points) const {
  const Patch4 patch = patches(triangles);
  const Coordinates4 within = along(patch, points);
  return {patch.uv.u + within.u, patch.uv.v + within.v};
}

Footprint4 SurfaceSource::footprints(const std::array<std::uint32_t, 4>& triangles, const Weights4& points,
                                     const Weights4& by_x, const Weights4& by_y) const {
  const Patch4 patch = patches(triangles);
  const Coordinates4 within = along(patch, points), x = along(patch, by_x), y = along(patch, by_y);
  return {patch.uv.u + within.u, patch.uv.v + within.v, x.u, x.v, y.u, y.v};
}

void SurfaceSource::add_taps(std::span<const std::uint32_t> triangles, const Footprint4& footprints, Looks looks,
                             TapList& taps, std::span<SurfaceTaps> to) const {
  const std::uint32_t number = patches_[triangles[0]].shade;
  if (std::ranges::any_of(triangles, [&](std::uint32_t t) { return patches_[t].shade != number; })) {
    for (std::size_t k = 0; k < triangles.size(); ++k)
      add_taps(triangles.subspan(k, 1), footprints.only(k), looks, taps, to.subspan(k, 1));
    return;
  }
  const MeshSource::Shade& shade = source_->shade(number);
  const auto image = [&](std::uint32_t map) -> const SourceTexture& { return source_->texture(map).image; };
  const auto begin = static_cast<std::uint32_t>(taps.count);
  std::ranges::fill(to, SurfaceTaps{});
  if (looks.colour && shade.texture != no_texture) {
    const auto ends = image(shade.texture).add_taps(footprints, triangles.size(), taps);
    for (std::size_t k = 0; k < to.size(); ++k)
      to[k].colour_begin = k == 0 ? begin : ends[k - 1], to[k].colour_end = ends[k];
  }
  if (!looks.normal || shade.normal_map == no_texture) return;
  const SourceTexture& normals = image(shade.normal_map);
  if (looks.colour && shade.texture != no_texture && normals.has_taps_of(image(shade.texture))) {
    for (SurfaceTaps& range : to) range.normal_begin = range.colour_begin, range.normal_end = range.colour_end;
    normals.prefetch(taps.between(begin, taps.count));
  } else {
    const auto middle = static_cast<std::uint32_t>(taps.count);
    const auto ends = normals.add_taps(footprints, triangles.size(), taps);
    for (std::size_t k = 0; k < to.size(); ++k)
      to[k].normal_begin = k == 0 ? middle : ends[k - 1], to[k].normal_end = ends[k];
  }
}

Float4 SurfaceSource::vertex_colour(const SurfacePoint& point) const {
  Float4 sum{};
  const std::array<float, 3> weight = weights(point);
  const bool opaque = shade_of(point.triangle).opaque;
  for (std::size_t k = 0; k < 3; ++k) {
    const Rgba8 c = mesh_.wedges.colour[corners_[point.triangle].v[k]];
    const std::array<float, 256>& linear = linear_of_srgb();
    const float alpha = opaque ? 1 : static_cast<float>(c.a) / 255;
    const Float4 value{linear[c.r] * alpha, linear[c.g] * alpha, linear[c.b] * alpha, alpha};
    sum += all4(weight[k]) * value;
  }
  return sum;
}

Float4 SurfaceSource::colour(const SurfacePoint& point, const Footprint& footprint) const {
  const MeshSource::Shade& shade = shade_of(point.triangle);
  Float4 colour = shade.factor;
  if (shade.texture != no_texture) colour *= source_->texture(shade.texture).image.filtered(footprint);
  colour += shade.added;
  return source_->has_vertex_colours() ? colour * vertex_colour(point) : colour;
}

Float4 SurfaceSource::colour(std::span<const SurfacePoint> points, std::span<const TextureTap> taps) const {
  const MeshSource::Shade& shade = shade_of(points[0].triangle);
  Float4 colour = shade.factor;
  if (shade.texture != no_texture) colour *= source_->texture(shade.texture).image.value(taps);
  colour += shade.added;
  if (!source_->has_vertex_colours()) return colour;
  Float4 vertices{};
  for (const SurfacePoint& point : points) vertices += vertex_colour(point);
  return colour * vertices;
}

// The triangle has a normal map.
void SurfaceSource::set_frame(std::uint32_t triangle) {
  const auto& [i, j, k] = corners_[triangle].v;
  const Vec3f to_b = mesh_.positions[j] - mesh_.positions[i], to_c = mesh_.positions[k] - mesh_.positions[i];
  const Vec2f p = mesh_.wedges.uv[i], q = mesh_.wedges.uv[j], r = mesh_.wedges.uv[k];
  const float bu = q.x - p.x, bv = q.y - p.y, cu = r.x - p.x, cv = r.y - p.y;
  const float turn = bu * cv - cu * bv < 0 ? -1.0f : 1.0f;
  patches_[triangle].to_u = turn * (cv * to_b - bv * to_c);
  patches_[triangle].to_v = turn * (bu * to_c - cu * to_b);
}

Vec3f SurfaceSource::smooth_normal(const SurfacePoint& point) const {
  return unit_or_zero(mixed(source_->normals(), corners_[point.triangle], weights(point)));
}

Vec3f SurfaceSource::normal(const SurfacePoint& point, const Footprint& footprint) const {
  const std::uint32_t map = shade_of(point.triangle).normal_map;
  const Vec3f mapped = map == no_texture ? Vec3f{} : to_vec3f(source_->texture(map).image.filtered(footprint));
  if (mapped != Vec3f{} && source_->texture(map).object_space) return unit_or_zero(mapped);
  const Vec3f smooth = smooth_normal(point);
  const Patch& patch = patches_[point.triangle];
  return mapped == Vec3f{} ? smooth : unit_or_zero(bent(patch.to_u, patch.to_v, smooth, mapped));
}

Float4 SurfaceSource::mapped_normal(std::uint32_t triangle, std::span<const TextureTap> taps) const {
  const std::uint32_t map = shade_of(triangle).normal_map;
  if (map == no_texture) return Float4{};
  Float4 value = source_->texture(map).image.value(taps);
  value[3] = source_->texture(map).object_space ? 1 : 0;
  return value;
}

// Four points in one triangle: its corners are loaded once.
SurfaceSource::Frame4 SurfaceSource::frame_of(std::uint32_t triangle, const Float4x3& weight) const {
  const auto spread = [](Vec3f v) { return Float4x3{all4(v.x), all4(v.y), all4(v.z)}; };
  const auto normal = [&](std::size_t corner) { return spread(source_->normals()[corners_[triangle].v[corner]]); };
  const Patch& patch = patches_[triangle];
  return {(weight.x * normal(0) + weight.y * normal(1)) + weight.z * normal(2), spread(patch.to_u), spread(patch.to_v)};
}

SurfaceSource::Frame4 SurfaceSource::frame_of(std::span<const SurfacePoint, 4> points) const {
  std::array<Float4, 4> normal, to_u, to_v;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint32_t triangle = points[k].triangle;
    const std::array<float, 3> w = weights(points[k]);
    const auto n = [&](std::size_t corner) { return to_float4(source_->normals()[corners_[triangle].v[corner]]); };
    normal[k] = all4(w[0]) * n(0) + all4(w[1]) * n(1) + all4(w[2]) * n(2);
    to_u[k] = to_float4(patches_[triangle].to_u), to_v[k] = to_float4(patches_[triangle].to_v);
  }
  const auto lanes = [](const std::array<Float4, 4>& v) {
    const Quads<Float4> columns = transposed(v[0], v[1], v[2], v[3]);
    return Float4x3{columns.a, columns.b, columns.c};
  };
  return {lanes(normal), lanes(to_u), lanes(to_v)};
}

void SurfaceSource::set_normals(std::span<const SurfacePoint> points, std::span<const Float4> mapped,
                                std::span<Float4> to) const {
  for (std::size_t i = 0; i < points.size(); i += 4) {
    const std::span<const SurfacePoint, 4> four(&points[i], 4);
    const auto lane = [&](std::size_t k) { return Float4{four[k].weight[0], four[k].weight[1], four[k].weight[2], 0}; };
    const Quads<Float4> weight = transposed(lane(0), lane(1), lane(2), lane(3)),
                        map = transposed(mapped[i], mapped[i + 1], mapped[i + 2], mapped[i + 3]);
    const std::uint32_t triangle = four[0].triangle;
    const bool is_one = four[1].triangle == triangle && four[2].triangle == triangle && four[3].triangle == triangle &&
                        patches_[triangle].is_part == 0;
    const Frame4 frame = is_one ? frame_of(triangle, {weight.a, weight.b, weight.c}) : frame_of(four);
    const Float4x3 smooth = unit_or_zero(frame.normal), value{map.a, map.b, map.c};
    const Int4 is_mapped = (value.x != all4(0)) | (value.y != all4(0)) | (value.z != all4(0));
    Float4x3 normal = smooth;
    if (bits(is_mapped) != 0) {
      const Float4x3 turned = bent(frame.to_u, frame.to_v, smooth, value);
      normal = select(is_mapped, select(map.d != all4(0), value, turned), smooth);
    }
    const Float4x3 result = (weight.a + weight.b + weight.c) * normal;
    const Quads<Float4> rows = transposed(result.x, result.y, result.z, Float4{});
    to[i] = rows.a, to[i + 1] = rows.b, to[i + 2] = rows.c, to[i + 3] = rows.d;
  }
}

}  // namespace lodestone::spherical
