// The parts of a material's textures that a tile shows, and their places in an atlas (tile_atlas.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/texture/image_codec.h"
#include "core/texture/page_packer.h"

namespace lodestone::atlas {

// The maps of a material, in the order of for_each_texture().
enum Map : std::size_t { colours, normals, metal_and_roughness, occlusion, emission, map_count };

[[nodiscard]] inline std::array<std::uint32_t, map_count> maps_of(const Material& m) {
  return {m.texture, m.normal_map, m.metallic_roughness.texture, m.occlusion.texture, m.emissive_map.texture};
}

// Half-open, in texels of the largest of a material's maps; may lie outside of it.
struct TexelBox {
  std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] std::int64_t width() const { return x1 - x0; }
  [[nodiscard]] std::int64_t height() const { return y1 - y0; }
  void include(const TexelBox& other) {
    x0 = std::min(x0, other.x0), y0 = std::min(y0, other.y0);
    x1 = std::max(x1, other.x1), y1 = std::max(y1, other.y1);
  }
};

// All that the tile shows of a material.
struct Use {
  std::uint32_t material = 0;
  std::array<std::shared_ptr<const PixelImage>, map_count> maps;
  PixelSize size{};  // of the texels below
  TextureWrap wrap_u{}, wrap_v{};
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> part_of;              // by vertex above
  std::vector<std::array<std::int64_t, 2>> shift;  // by vertex above: whole repetitions to be subtracted
  std::vector<TexelBox> parts;
  std::vector<PagePlace> places;  // of parts, with their gutters
};

inline constexpr std::uint32_t gutter = 8;      // texels on each side; places are multiples of it
inline constexpr std::uint32_t plain_side = 8;  // of the part of a material without textures

// The side of a part with its gutters, and the texels that it takes.
[[nodiscard]] inline std::uint32_t padded(std::int64_t side) {
  return (static_cast<std::uint32_t>(side) + 2 * gutter + gutter - 1) / gutter * gutter;
}
[[nodiscard]] inline std::uint64_t padded_area(const TexelBox& box) {
  return std::uint64_t{padded(box.width())} * padded(box.height());
}

[[nodiscard]] inline Vec2f parent_uv(const Cell& cell, const Cell& parent, std::uint32_t v) {
  return parent.attributes.uv[cell.parents[v]];
}

// Boxes around the charts of the use's vertices, those that overlap as one; parent: null unless the tile morphs. False
// if a chart covers too much of the plane.
[[nodiscard]] bool find_parts(const Cell& cell, const Cell* parent, Use& use);

// Gives all parts their places; returns the size of the atlas, empty if they do not fit.
[[nodiscard]] std::optional<PixelSize> pack(std::span<Use* const> uses, std::uint32_t longest_side);

}  // namespace lodestone::atlas
