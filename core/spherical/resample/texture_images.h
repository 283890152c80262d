// Normals of resampled images as whole numbers: 16 bits per component, or two octahedral coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "core/texture/downsample.h"

namespace lodestone::spherical {

// Rows from the top; 0 is the least value, 65535 the greatest.
struct WideImage {
  PixelSize size;
  std::uint32_t channels = 3;
  std::vector<std::uint16_t> values;
};

// Components of 3-channel normals, -1 to 1. 0 is at 32767.5: neither code for it exists, as in every format of unsigned
// normals.
[[nodiscard]] WideImage wide_normals(const LinearImage& normals);

// Two channels: the octahedral coordinates of each direction (meyer2010), -1 to 1. Mirrored texels get equal codes. The
// codes of directions on both sides of the fold are far apart: not to be interpolated before they are decoded, and not
// to be compressed with loss.
[[nodiscard]] WideImage folded_normals(const LinearImage& normals);

// The inverses, of unit length.
[[nodiscard]] LinearImage normals_of(const WideImage& image);

}  // namespace lodestone::spherical
