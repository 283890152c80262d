// The promises of every reader about attributes, checked without the code that makes them, for tests and fuzzing.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Describes the fault of the attributes of a mesh; empty if there is none.
[[nodiscard]] inline std::string wedge_mistake(const RawMesh& mesh) {
  const RawWedges& w = mesh.wedges;
  const std::size_t count = wedge_count(mesh);
  for (const std::size_t size : {w.uv.size(), w.normal.size(), w.colour.size()})
    if (size != 0 && size != count) return "attributes of different counts";
  if (count != 0 && w.corners.empty() && count != mesh.positions.size())
    return "neither one wedge per vertex nor corners";
  if (!w.corners.empty()) {
    if (w.corners.size() != mesh.triangles.size()) return "corners of some triangles only";
    std::vector<std::int64_t> vertex_of(count, -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t wedge = w.corners[t].v[k], vertex = mesh.triangles[t].v[k];
        if (wedge >= count) return "a wedge out of range";
        if (vertex_of[wedge] >= 0 && vertex_of[wedge] != vertex) return "a wedge of two vertices";
        vertex_of[wedge] = vertex;
      }
  }
  for (const Vec3f& n : w.normal) {
    const float size = length(n);
    if (!(size == 0 || std::abs(size - 1) < 1e-5f)) return "a normal that is neither of unit length nor zero";
  }
  if (!w.material.empty() && w.material.size() != mesh.triangles.size()) return "materials of some triangles only";
  for (const std::uint32_t material : w.material)
    if (material != no_material && material >= mesh.materials.size()) return "a material out of range";
  bool textures_exist = true;
  for (const Material& material : mesh.materials)
    for_each_texture(material, [&](std::uint32_t texture) {
      textures_exist &= texture == no_texture || texture < mesh.textures.size();
    });
  if (!textures_exist) return "a texture out of range";
  for (const Material& material : mesh.materials)
    for (const float c : material.base_colour)
      if (!(c >= 0 && c <= 1)) return "a base colour out of range";
  for (const Texture& texture : mesh.textures)
    if (texture.bytes.empty() || !texture.media_type.starts_with("image/")) return "a texture that is not an image";
  return {};
}

// The attributes at a corner, wherever they are stored.
struct CornerValues {
  Vec2f uv;
  Vec3f normal;
  Rgba8 colour;
  friend bool operator==(const CornerValues&, const CornerValues&) = default;
};
[[nodiscard]] inline CornerValues values_at(const RawMesh& mesh, std::size_t triangle, std::size_t corner) {
  const RawWedges& w = mesh.wedges;
  const std::uint32_t wedge = (w.corners.empty() ? mesh.triangles : w.corners)[triangle].v[corner];
  return {w.uv.empty() ? Vec2f{} : w.uv[wedge], w.normal.empty() ? Vec3f{} : w.normal[wedge],
          w.colour.empty() ? Rgba8{} : w.colour[wedge]};
}

}  // namespace lodestone
