// Images over the octahedral square that have no seam: how they continue beyond its sides, and their mip levels.
//
// A texel covers its cell of the square, as graphics hardware has it. Beyond a side the image continues with its own
// mirror image on the same side: texel (i, n) is texel (n - 1 - i, n - 1). An image is *symmetric* if the texels along
// each side read the same in both directions; its four corners are then equal, too. In a symmetric image the texel
// beyond a side equals the texel at the side, so that the plain clamping of textures, in every viewer, is the right
// continuation, and both copies of a point on the cut show the same colour at every level.
// docs/decisions/0040-octahedral-images.md has the alternatives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/spherical/octahedron/octahedral_map.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

struct Texel {
  std::int64_t x = 0, y = 0;
  friend constexpr bool operator==(const Texel&, const Texel&) = default;
};

// The texel of an n x n image that continues it at p; at most n texels beyond a side.
[[nodiscard]] constexpr Texel continued(Texel p, std::int64_t n) {
  if (p.x < 0) p = {-1 - p.x, n - 1 - p.y};
  if (p.x >= n) p = {2 * n - 1 - p.x, n - 1 - p.y};
  if (p.y < 0) p = {n - 1 - p.x, -1 - p.y};
  if (p.y >= n) p = {n - 1 - p.x, 2 * n - 1 - p.y};
  return p;
}

// The image at a point, by the weights of the four nearest texels. Square images only.
[[nodiscard]] std::array<float, 4> sample(const LinearImage& image, SquarePoint p);

// Makes an image symmetric: each texel on a side becomes the mean of itself and its mirror image, each corner the mean
// of the four. A texel at a side covers half of what lies within its width of the cut; the mean covers both halves.
// Throws InputError if the image is not square.
void average_border(LinearImage& image);

// Makes an image symmetric again that a lossy code has altered, whatever its values encode: the first of the mirrored
// texels counts. `values` has n rows of n texels of `channels` values.
template <class Value>
void copy_border(std::span<Value> values, std::size_t n, std::size_t channels) {
  const auto copy = [&](std::size_t from, std::size_t to) {
    for (std::size_t c = 0; c < channels; ++c) values[to * channels + c] = values[from * channels + c];
  };
  const std::size_t last = n - 1;
  for (std::size_t i = 0; 2 * i < last; ++i) {
    copy(i, last - i);
    copy(i * n, (last - i) * n);
    copy(last * n + i, last * n + (last - i));
    copy(i * n + last, (last - i) * n + last);
  }
  if (n > 1) copy(0, last * n + last);
}

// Symmetric levels from the image itself down to one texel, each half of the unrounded one before. Throws InputError
// if the image is not square.
[[nodiscard]] std::vector<PixelImage> symmetric_levels(LinearImage image, PixelMeaning meaning);

}  // namespace lodestone::spherical
