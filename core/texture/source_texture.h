// A texture of a source surface, for filtering: levels of linear values in which only texels within charts count.
//
// Texels outside of the charts get values from the charts' own next to them, at every level, so that filters that reach
// beyond a border find no background. Between texels values are interpolated; a footprint that is longer than wide is
// sampled along its length by several samples.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "core/math/lanes/float4.h"
#include "core/math/vec3.h"
#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone {

// A parallelogram in texture coordinates: what a sample of another image covers.
struct Footprint {
  Vec2f centre, along_x, along_y;
};

// Four of them, one in each lane.
struct Footprint4 {
  Float4 centre_u, centre_v, along_x_u, along_x_v, along_y_u, along_y_v;

  [[nodiscard]] Footprint lane(std::size_t k) const {
    return {{centre_u[k], centre_v[k]}, {along_x_u[k], along_x_v[k]}, {along_y_u[k], along_y_v[k]}};
  }
  // Lane k in all lanes.
  [[nodiscard]] Footprint4 only(std::size_t k) const {
    return {all4(centre_u[k]),  all4(centre_v[k]),  all4(along_x_u[k]),
            all4(along_x_v[k]), all4(along_y_u[k]), all4(along_y_v[k])};
  }
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

  // Colours: light times alpha, and alpha, in [0, 1]. Normals: components in [-1, 1]; the fourth means nothing. Values:
  // in [0, 1].
  [[nodiscard]] Float4 filtered(const Footprint& footprint) const;
  // The same in two steps, for many footprints at a time: the texels are asked for before they are needed. The taps of
  // the first `count` lanes follow each other; returns where those of each end. count: 1 to 4.
  std::array<std::uint32_t, 4> add_taps(const Footprint4& footprints, std::size_t count, TapList& taps) const;
  void prefetch(std::span<const TextureTap> taps) const;
  [[nodiscard]] Float4 value(std::span<const TextureTap> taps) const {
    Float4 sum{};
    for (const TextureTap& tap : taps) sum += weighted(tap);
    return decoded(sum);
  }
  // True if both have the same taps for any footprint.
  [[nodiscard]] bool has_taps_of(const SourceTexture& other) const {
    return levels_.front().size == other.levels_.front().size && wrap_u_ == other.wrap_u_ && wrap_v_ == other.wrap_v_;
  }
  [[nodiscard]] bool empty() const { return levels_.empty(); }

 private:
  using Texel = std::array<std::uint16_t, 4>;
  struct Level {
    PixelSize size;
    float width = 0, height = 0;  // the size
    std::uint32_t first = 0;      // of texels_
    [[nodiscard]] std::size_t count() const { return std::size_t{size.width} * size.height; }
  };
  struct Sampling4;
  void set_finest(const PixelImage& image);
  void add_levels(std::vector<std::uint8_t> covered);
  void extend(const Level& level, std::vector<std::uint8_t>& covered);
  // Calls body(tap) for the taps whose sum is the value.
  template <class Body>
  void for_each_tap(const Footprint& footprint, Body body) const;
  template <class Body>
  void tap(const Level& level, Vec2f uv, float weight, Body& body) const;
  [[nodiscard]] Sampling4 sampling_of(const Footprint4& footprints) const;
  bool add_inner_taps(const Footprint4& footprints, std::span<std::uint32_t> ends, TapList& taps) const;
  [[nodiscard]] Float4 weighted(const TextureTap& tap) const;
  [[nodiscard]] Float4 decoded(Float4 sum) const {
    constexpr float scale = 1.0f / 65535;
    return meaning_ != PixelMeaning::normals ? all4(scale) * sum : all4(2 * scale) * sum - all4(1);
  }

  std::vector<Level> levels_;
  std::vector<Texel> texels_;  // of all levels; one more at the end, so that each begins a pair
  TextureWrap wrap_u_ = TextureWrap::repeat, wrap_v_ = TextureWrap::repeat;
  PixelMeaning meaning_ = PixelMeaning::colours;
};

inline Float4 SourceTexture::weighted(const TextureTap& tap) const {
  using Short8 = std::uint16_t __attribute__((vector_size(16)));
  const auto pair = [this](std::uint32_t first) {
    Short8 texels;
    std::memcpy(&texels, &texels_[first], sizeof texels);
    return texels;
  };
  const auto numbers = [](Short8 v) { return __builtin_convertvector(reinterpret_cast<Int4>(v), Float4); };
  const auto first = [&](Short8 v) { return numbers(__builtin_shufflevector(v, Short8{}, 0, 8, 1, 9, 2, 10, 3, 11)); };
  const auto second = [&](Short8 v) { return numbers(__builtin_shufflevector(v, Short8{}, 4, 8, 5, 9, 6, 10, 7, 11)); };
  const Short8 above = pair(tap.upper), below = pair(tap.lower);
  const Float4 across = all4(tap.across), a = first(above), c = first(below);
  const Float4 upper = a + across * (second(above) - a), lower = c + across * (second(below) - c);
  return all4(tap.weight) * (upper + all4(tap.down) * (lower - upper));
}

}  // namespace lodestone
