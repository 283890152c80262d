// A sphere with an atlas of eight charts, painted with a function of the direction; the background is black.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "core/spherical/surface.h"
#include "core/texture/colour.h"
#include "core/texture/image_codec.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::test {

// Light at a direction, or a vector.
using Paint = std::function<Vec3d(Vec3d)>;

inline Vec3d waves(Vec3d d) {
  return {0.5 + 0.3 * std::sin(2 * d.x + d.y), 0.5 + 0.3 * std::sin(2 * d.y + d.z), 0.5 + 0.3 * std::sin(2 * d.z)};
}

struct PaintedSphere {
  IndexedMesh mesh;
  spherical::Surface surface;
  std::vector<Vec3d> directions;  // of the surface's vertices
};

// The surface of a mesh that is closed as it is, with the first wedges for vertices.
inline spherical::Surface surface_of(const IndexedMesh& mesh) {
  spherical::Surface surface;
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle& triangle = surface.triangles.emplace_back();
    surface.source_triangle.push_back(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t wedge = mesh.triangles[t].v[k];
      const std::uint32_t vertex = mesh.wedges.vertex.empty() ? wedge : mesh.wedges.vertex[wedge];
      const auto [at, is_new] = number.try_emplace(vertex, static_cast<std::uint32_t>(surface.positions.size()));
      triangle.v[k] = at->second;
      if (!is_new) continue;
      surface.positions.push_back(to_double(mesh.positions[vertex]));
      surface.source_vertex.push_back(vertex);
    }
  }
  return surface;
}

inline constexpr std::uint32_t chart_cell = 64;  // texels; charts are the lower left halves of 4 x 2 cells, 4 within

inline Vec2f place_in_atlas(std::uint32_t octant, double y, double z) {
  constexpr double scale = chart_cell - 8;
  const double s = chart_cell * (octant % 4) + 4 + scale * y, t = chart_cell * (octant / 4) + 4 + scale * z;
  return {static_cast<float>(s / (4 * chart_cell)), static_cast<float>(t / (2 * chart_cell))};
}

// encoded(v): the byte of a component of the paint.
inline PixelImage atlas(const Paint& paint, const std::function<std::uint8_t(double)>& encoded) {
  PixelImage image{.size = {4 * chart_cell, 2 * chart_cell}, .channels = 3, .pixels = {}};
  for (std::uint32_t j = 0; j < image.size.height; ++j)
    for (std::uint32_t i = 0; i < image.size.width; ++i) {
      const double y = (i % chart_cell + 0.5 - 4) / (chart_cell - 8), z = (j % chart_cell + 0.5 - 4) / (chart_cell - 8);
      const std::uint32_t octant = i / chart_cell + 4 * (j / chart_cell);
      const Vec3d d{(octant & 1u ? -1 : 1) * (1 - y - z), (octant & 2u ? -1 : 1) * y, (octant & 4u ? -1 : 1) * z};
      const bool within = y >= -1e-9 && z >= -1e-9 && y + z <= 1 + 1e-9;
      const Vec3d value = within ? paint((1 / length(d)) * d) : Vec3d{};
      for (const double v : {value.x, value.y, value.z}) image.pixels.push_back(within ? encoded(v) : std::uint8_t{0});
    }
  return image;
}

inline Texture texture_of(const PixelImage& image) {
  Texture texture;
  texture.name = "painted";
  texture.media_type = "image/png";
  texture.bytes = encode_image(image, texture.media_type);
  return texture;
}

inline PaintedSphere painted_sphere(int subdivisions, const Paint& paint = waves) {
  const SphereMesh sphere = octahedron_on_sphere(subdivisions);
  PaintedSphere painted;
  IndexedMesh& mesh = painted.mesh;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> wedges;
  std::map<std::uint32_t, std::uint32_t> first;
  for (const Triangle& triangle : sphere.triangles) {
    Vec3d middle{};
    for (const std::uint32_t v : triangle.v) middle = middle + sphere.directions[v];
    const std::uint32_t octant = (middle.x < 0 ? 1u : 0u) + (middle.y < 0 ? 2u : 0u) + (middle.z < 0 ? 4u : 0u);
    Triangle& corners = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangle.v[k];
      const auto wedge = static_cast<std::uint32_t>(mesh.positions.size());
      const auto [at, is_new] = wedges.try_emplace({octant, v}, wedge);
      corners.v[k] = at->second;
      if (!is_new) continue;
      const Vec3d d = sphere.directions[v];
      const double whole = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
      mesh.positions.push_back(to_float(Vec3d{0.5, 0.5, 0.5} + 0.5 * d));
      mesh.wedges.normal.push_back(to_float(d));
      mesh.wedges.vertex.push_back(first.try_emplace(v, wedge).first->second);
      mesh.wedges.uv.push_back(place_in_atlas(octant, std::abs(d.y) / whole, std::abs(d.z) / whole));
    }
  }
  mesh.wedges.textures.push_back(texture_of(atlas(paint, [](double v) { return unit_to_byte(linear_to_srgb(v)); })));
  Material material;
  material.texture = 0;
  mesh.wedges.materials.push_back(material);
  painted.surface = surface_of(mesh);
  for (const Vec3d p : painted.surface.positions) {
    const Vec3d d = p - Vec3d{0.5, 0.5, 0.5};
    painted.directions.push_back((1 / length(d)) * d);
  }
  return painted;
}

}  // namespace lodestone::test
