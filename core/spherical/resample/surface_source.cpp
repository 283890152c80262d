#include "core/spherical/resample/surface_source.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/error.h"
#include "core/formats/common/colour.h"
#include "core/mesh/vertex_of.h"

namespace lodestone::spherical {
namespace {

constexpr Triangle no_corners{{no_source, no_source, no_source}};

Vec3f unit_or_zero(Vec3f v) {
  const float size = length(v);
  return size > 0 ? (1 / size) * v : Vec3f{};
}

// A normal of tangent space: x is the direction in which u grows, made perpendicular to the normal, y is on the side
// where v falls.
Vec3f bent(const TextureFrame& frame, Vec3f normal, Vec3f mapped) {
  const Vec3f t = unit_or_zero(frame.to_u - dot(normal, frame.to_u) * normal);
  if (t == Vec3f{}) return normal;
  const Vec3f b = cross(normal, t);
  return (mapped.x * t + (dot(b, frame.to_v) > 0 ? -mapped.y : mapped.y) * b) + mapped.z * normal;
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
    Vec2f p = mesh_.wedges.uv[i], q = mesh_.wedges.uv[j], r = mesh_.wedges.uv[k];
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
  if (parts_.empty()) return point.weight;
  const auto part = parts_.find(point.triangle);
  if (part == parts_.end()) return point.weight;
  std::array<float, 3> sum{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) sum[i] += point.weight[k] * part->second[k][i];
  return sum;
}

SurfaceTaps SurfaceSource::add_taps(std::uint32_t triangle, const Footprint& footprint, Looks looks,
                                    TapList& taps) const {
  const MeshSource::Shade& shade = shade_of(triangle);
  const auto image = [&](std::uint32_t map) -> const SourceTexture& { return source_->texture(map).image; };
  SurfaceTaps ranges{taps.count, taps.count, 0, 0};
  if (looks.colour && shade.texture != no_texture) image(shade.texture).add_taps(footprint, taps);
  ranges.colour_end = ranges.normal_begin = ranges.normal_end = taps.count;
  if (!looks.normal || shade.normal_map == no_texture) return ranges;
  const SourceTexture& normals = image(shade.normal_map);
  if (looks.colour && shade.texture != no_texture && normals.has_taps_of(image(shade.texture))) {
    ranges.normal_begin = ranges.colour_begin;
    normals.prefetch(taps.between(ranges.colour_begin, ranges.colour_end));
  } else {
    normals.add_taps(footprint, taps);
    ranges.normal_end = taps.count;
  }
  return ranges;
}

Float4 SurfaceSource::vertex_colour(const SurfacePoint& point) const {
  Float4 sum{};
  const std::array<float, 3> weight = weights(point);
  for (std::size_t k = 0; k < 3; ++k) {
    const Rgba8 c = mesh_.wedges.colour[corners_[point.triangle].v[k]];
    const std::array<float, 256>& linear = linear_of_srgb();
    const float alpha = static_cast<float>(c.a) / 255;
    const Float4 value{linear[c.r] * alpha, linear[c.g] * alpha, linear[c.b] * alpha, alpha};
    sum += all4(weight[k]) * value;
  }
  return sum;
}

Float4 SurfaceSource::colour(const SurfacePoint& point, const Footprint& footprint) const {
  const MeshSource::Shade& shade = shade_of(point.triangle);
  Float4 colour = shade.base_colour;
  if (shade.texture != no_texture) colour *= source_->texture(shade.texture).image.filtered(footprint);
  return mesh_.wedges.colour.empty() ? colour : colour * vertex_colour(point);
}

Float4 SurfaceSource::colour(std::span<const SurfacePoint> points, std::span<const TextureTap> taps) const {
  const MeshSource::Shade& shade = shade_of(points[0].triangle);
  Float4 colour = shade.base_colour;
  if (shade.texture != no_texture) colour *= source_->texture(shade.texture).image.value(taps);
  if (mesh_.wedges.colour.empty()) return colour;
  Float4 vertices{};
  for (const SurfacePoint& point : points) vertices += vertex_colour(point);
  return colour * vertices;
}

TextureFrame SurfaceSource::frame_of(std::uint32_t triangle) const {
  const auto& [i, j, k] = corners_[triangle].v;
  const Vec3f to_b = mesh_.positions[j] - mesh_.positions[i], to_c = mesh_.positions[k] - mesh_.positions[i];
  const Vec2f p = mesh_.wedges.uv[i], q = mesh_.wedges.uv[j], r = mesh_.wedges.uv[k];
  const float bu = q.x - p.x, bv = q.y - p.y, cu = r.x - p.x, cv = r.y - p.y;
  const float turn = bu * cv - cu * bv < 0 ? -1.0f : 1.0f;
  return {triangle, turn * (cv * to_b - bv * to_c), turn * (bu * to_c - cu * to_b)};
}

Vec3f SurfaceSource::smooth_normal(const SurfacePoint& point) const {
  return unit_or_zero(mixed(source_->normals(), corners_[point.triangle], weights(point)));
}

Vec3f SurfaceSource::normal(const SurfacePoint& point, const Footprint& footprint) const {
  const std::uint32_t map = shade_of(point.triangle).normal_map;
  const Vec3f mapped = map == no_texture ? Vec3f{} : to_vec3f(source_->texture(map).image.filtered(footprint));
  if (mapped != Vec3f{} && source_->texture(map).object_space) return unit_or_zero(mapped);
  const Vec3f smooth = smooth_normal(point);
  return mapped == Vec3f{} ? smooth : unit_or_zero(bent(frame_of(point.triangle), smooth, mapped));
}

// The mean of the surface's normals, each bent in the same way.
Vec3f SurfaceSource::normal(std::span<const SurfacePoint> points, std::span<const TextureTap> taps,
                            TextureFrame& frame) const {
  const std::uint32_t map = shade_of(points[0].triangle).normal_map;
  const Vec3f mapped = map == no_texture ? Vec3f{} : to_vec3f(source_->texture(map).image.value(taps));
  if (mapped != Vec3f{} && source_->texture(map).object_space) return unit_or_zero(mapped);
  Vec3f sum{};
  for (const SurfacePoint& point : points) {
    const Vec3f smooth = smooth_normal(point);
    const float share = point.weight[0] + point.weight[1] + point.weight[2];
    if (mapped != Vec3f{} && frame.triangle != point.triangle) frame = frame_of(point.triangle);
    sum = sum + share * (mapped == Vec3f{} ? smooth : bent(frame, smooth, mapped));
  }
  return unit_or_zero(sum);
}

}  // namespace lodestone::spherical
