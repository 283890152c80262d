// A texture of a source surface, for filtering: levels of linear values in which only texels within charts count.
//
// Texels outside of the charts get values from the charts' own next to them, at every level, so that filters that reach
// beyond a border find no background. Between texels values are interpolated; a footprint that is longer than wide is
// sampled along its length by several samples.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/lanes/float4.h"
#include "core/math/vec2.h"
#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

// A parallelogram in texture coordinates: what a sample of another image covers.
struct Footprint {
  Vec2f centre, along_x, along_y;
};

// A reading of a texture between four texels: a pair side by side of a row, and one of the next row.
struct TextureTap {
  std::uint32_t upper = 0, lower = 0;  // the first texels of the pairs
  float across = 0, down = 0;          // shares of the second texels and of the lower row
  float weight = 0;
};

// Many taps, in memory that is reused.
struct TapList {
  std::vector<TextureTap> room;
  std::size_t count = 0;
  [[nodiscard]] std::span<const TextureTap> between(std::size_t begin, std::size_t end) const {
    return std::span(room).subspan(begin, end - begin);
  }
};

class SourceTexture {
 public:
  SourceTexture() = default;
  // covered: one byte per pixel (chart_cover.h). 11 bytes per pixel.
  SourceTexture(const PixelImage& image, PixelMeaning meaning, TextureWrap wrap_u, TextureWrap wrap_v,
                std::vector<std::uint8_t> covered);

  // Colours: light times alpha, and alpha, in [0, 1]. Normals: components in [-1, 1]; the fourth means nothing.
  [[nodiscard]] Float4 filtered(const Footprint& footprint) const;
  // The same in two steps, for many footprints at a time: the texels are asked for before they are needed.
  void add_taps(const Footprint& footprint, TapList& taps) const;
  void prefetch(std::span<const TextureTap> taps) const;
  [[nodiscard]] Float4 value(std::span<const TextureTap> taps) const;
  // True if both have the same taps for any footprint.
  [[nodiscard]] bool has_taps_of(const SourceTexture& other) const {
    return levels_.front().size == other.levels_.front().size && wrap_u_ == other.wrap_u_ && wrap_v_ == other.wrap_v_;
  }
  [[nodiscard]] bool empty() const { return levels_.empty(); }

 private:
  using Texel = std::array<std::uint16_t, 4>;
  struct Level {
    PixelSize size;
    std::size_t first = 0;  // of texels_
    [[nodiscard]] std::size_t count() const { return std::size_t{size.width} * size.height; }
  };
  void add_levels(std::vector<std::uint8_t> covered);
  void extend(const Level& level, std::vector<std::uint8_t>& covered);
  // Calls body(tap) for the taps whose sum is the value.
  template <class Body>
  void for_each_tap(const Footprint& footprint, Body body) const;
  template <class Body>
  void tap(const Level& level, Vec2f uv, float weight, Body& body) const;
  [[nodiscard]] Float4 weighted(const TextureTap& tap) const;
  [[nodiscard]] Float4 decoded(Float4 sum) const;

  std::vector<Level> levels_;
  std::vector<Texel> texels_;  // of all levels; one more at the end, so that each begins a pair
  TextureWrap wrap_u_ = TextureWrap::repeat, wrap_v_ = TextureWrap::repeat;
  PixelMeaning meaning_ = PixelMeaning::colours;
};

}  // namespace lodestone::spherical
