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

class SourceTexture {
 public:
  SourceTexture() = default;
  // covered: one byte per pixel (chart_cover.h). 11 bytes per pixel.
  SourceTexture(const PixelImage& image, PixelMeaning meaning, TextureWrap wrap_u, TextureWrap wrap_v,
                std::vector<std::uint8_t> covered);

  // Colours: light times alpha, and alpha, in [0, 1]. Normals: components in [-1, 1]; the fourth means nothing.
  [[nodiscard]] Float4 filtered(const Footprint& footprint) const;
  [[nodiscard]] bool empty() const { return levels_.empty(); }

 private:
  using Texel = std::array<std::uint16_t, 4>;
  struct Level {
    PixelSize size;
    std::vector<Texel> texels;
  };
  void add_levels(std::vector<std::uint8_t> covered);
  void extend(Level& level, std::vector<std::uint8_t>& covered) const;
  [[nodiscard]] Float4 interpolated(const Level& level, Vec2f uv) const;

  std::vector<Level> levels_;
  TextureWrap wrap_u_ = TextureWrap::repeat, wrap_v_ = TextureWrap::repeat;
  PixelMeaning meaning_ = PixelMeaning::colours;
};

}  // namespace lodestone::spherical
