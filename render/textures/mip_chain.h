// A texture as shading reads it: its levels, each half the size of the one before (williams1983).
//
// All levels are made once, in memory, and are the same bytes for every backend. Between texels and between levels
// backends interpolate the bytes as they are: colours go to the picture without a transfer curve
// (render/frame/shading.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone {

// Texels of one level, red in the lowest byte, alpha in the highest, with a border of one texel all around, by the
// texture's wrap modes. Interpolation takes two by two neighbours anywhere from half a texel outside the image on, and
// needs to know nothing of wrapping.
struct MipLevel {
  PixelSize size;                     // without the border
  std::vector<std::uint32_t> texels;  // (width + 2) (height + 2)

  [[nodiscard]] std::uint32_t stride() const { return size.width + 2; }
  [[nodiscard]] std::uint32_t rows() const { return size.height + 2; }
};

// From the image itself down to a single texel; the box filter of core/texture/downsample.h, each level from the
// unrounded one before. Alpha has no weight; where it is not kept, it is 255. Memory: 11 bytes per pixel while it is
// made, 5.4 after.
enum class TexelAlpha : std::uint8_t { left_out, kept };
[[nodiscard]] std::vector<MipLevel> make_mip_chain(PixelImage image, PixelMeaning meaning, TextureWrap wrap_u,
                                                   TextureWrap wrap_v, TexelAlpha alpha = TexelAlpha::left_out);

// Drawn instead of a texture that cannot be had: 8 x 8 fields of magenta and black.
[[nodiscard]] PixelImage placeholder_image();

}  // namespace lodestone
