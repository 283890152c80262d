// Octahedral images as files hold them: PNG, JPEG or WebP; normals in PNG with 16 bits per component.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

// As encode_image() and decode_image(). Colours that are opaque everywhere lose their alpha; normals in WebP with loss
// of up to 5461 pixels a side are three grey images below one another, x, y and z, coded with two thirds of the
// quality: 90 gives them some 40 dB, as colours have. What comes back is seamless again: symmetric
// (octahedral_image.h), or with margins that continue the squares of an atlas (square_atlas.h).
[[nodiscard]] std::vector<char> encode_octahedral(const LinearImage& image, PixelMeaning meaning,
                                                  const std::string& media_type, int quality);
[[nodiscard]] LinearImage decode_octahedral(std::span<const char> bytes, PixelMeaning meaning,
                                            const std::string& media_type, const OctahedralLayout& layout);

// Normals of 3 channels, components from -1 to 1. 0 is at 32767.5: neither code for it exists, as in every format of
// unsigned normals.
[[nodiscard]] WideImage wide_normals(const LinearImage& normals);
// The inverse, of unit length.
[[nodiscard]] LinearImage normals_of(const WideImage& image);

}  // namespace lodestone::spherical
