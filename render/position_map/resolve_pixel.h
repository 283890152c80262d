// The values of a pixel whose triangle is known: the same operations, in double precision, on every backend.
//
// The weights of the corners are those of the point where the ray through the pixel's centre meets the triangle's
// plane: volumes of the tetrahedra between the ray and two corners, which serve parallel and central projection alike.
// A centre that lies outside by a part of a subpixel (vertices are snapped for coverage) is taken to the border of the
// triangle: a map holds points of the surface and no others.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"
#include "render/position_map/map_view.h"
#include "render/position_map/position_map.h"

namespace lodestone {

using CornerWeights = std::array<double, 3>;

[[nodiscard]] inline CornerWeights corner_weights(const Ray& ray, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d oa = a - ray.origin, ob = b - ray.origin, oc = c - ray.origin;
  CornerWeights w{dot(ray.direction, cross(ob, oc)), dot(ray.direction, cross(oc, oa)),
                  dot(ray.direction, cross(oa, ob))};
  const double turned = (w[0] + w[1]) + w[2] < 0 ? -1.0 : 1.0;
  for (double& v : w) v = turned * v > 0 ? turned * v : 0;
  const double sum = (w[0] + w[1]) + w[2];
  if (!(sum > 0)) return {1.0 / 3, 1.0 / 3, 1.0 / 3};  // seen from its edge
  return {w[0] / sum, w[1] / sum, w[2] / sum};
}

[[nodiscard]] inline Vec3f unit_normal_of(Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d n = cross(b - a, c - a);
  const double norm = length(n);
  return norm > 0 ? to_float((1 / norm) * n) : Vec3f{};
}

[[nodiscard]] inline std::uint8_t blend_byte(const CornerWeights& w, std::uint8_t a, std::uint8_t b, std::uint8_t c) {
  return static_cast<std::uint8_t>(((w[0] * a + w[1] * b) + w[2] * c) + 0.5);
}

// Fills pixel `i`, whose triangle is set, from the mesh; empty arrays of the map remain empty.
inline void resolve_pixel(const IndexedMesh& mesh, std::size_t i, PositionMap& map) {
  const auto width = static_cast<std::size_t>(map.view.width);
  const Ray ray = ray_through(map.view, static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
  const Triangle& t = mesh.triangles[map.triangle[i]];
  const Vec3d a = to_double(mesh.positions[t.v[0]]), b = to_double(mesh.positions[t.v[1]]),
              c = to_double(mesh.positions[t.v[2]]);
  const CornerWeights w = corner_weights(ray, a, b, c);
  const Vec3d p = (w[0] * a + w[1] * b) + w[2] * c;
  map.position[i] = to_float(p);
  map.depth[i] = static_cast<float>(map.view.depth(p));
  map.normal[i] = unit_normal_of(a, b, c);
  if (!map.uv.empty()) {
    const auto mix = [&](auto part) {
      return static_cast<float>((w[0] * part(mesh.wedges.uv[t.v[0]]) + w[1] * part(mesh.wedges.uv[t.v[1]])) +
                                w[2] * part(mesh.wedges.uv[t.v[2]]));
    };
    map.uv[i] = {mix([](Vec2f uv) { return static_cast<double>(uv.x); }),
                 mix([](Vec2f uv) { return static_cast<double>(uv.y); })};
  }
  if (!map.colour.empty()) {
    const Rgba8 &r = mesh.wedges.colour[t.v[0]], &s = mesh.wedges.colour[t.v[1]], &u = mesh.wedges.colour[t.v[2]];
    map.colour[i] = {blend_byte(w, r.r, s.r, u.r), blend_byte(w, r.g, s.g, u.g), blend_byte(w, r.b, s.b, u.b),
                     blend_byte(w, r.a, s.a, u.a)};
  }
}

// An empty map, with room for the requested channels that the mesh has in these groups.
[[nodiscard]] inline PositionMap empty_map(const IndexedMesh& mesh, const MapView& view, MapChannels channels,
                                           const std::shared_ptr<const PixelGroups>& groups) {
  PositionMap map;
  map.view = view;
  map.transform = mesh.transform;
  map.triangle = PixelArray(groups, no_triangle);
  map.depth = PixelArray<float>(groups);
  if (channels.surface) map.position = PixelArray<Vec3f>(groups), map.normal = PixelArray<Vec3f>(groups);
  if (channels.uv && !mesh.wedges.uv.empty()) map.uv = PixelArray<Vec2f>(groups);
  if (channels.colour && !mesh.wedges.colour.empty()) map.colour = PixelArray(groups, Rgba8{0, 0, 0, 0});
  return map;
}

}  // namespace lodestone
