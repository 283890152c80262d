// Many small octahedral images in one: for components that are not worth images of their own.
//
// Each image has a square of the atlas, of a power of two, with a margin of an eighth of its side on all sides. The
// margin continues the image as octahedral_image.h has it, so that filters that reach beyond a side find what is there
// on the sphere, and both copies of a point on the cut show the same. Plain halving keeps this: the margin of a level
// is the continuation of its image as long as the square has at least 8 texels, and a square of 4 texels, whose
// outermost ones have their centres on the sides of the image, is symmetric. Smaller ones show the colours of their
// neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/octahedron/octahedral_map.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

struct AtlasSquare {
  static constexpr std::uint32_t least_side = 16;
  std::uint32_t x = 0, y = 0, side = 0;  // texels
  [[nodiscard]] std::uint32_t margin() const { return side / 8; }
  [[nodiscard]] std::uint32_t image() const { return side - 2 * margin(); }  // texels along the image's side
  friend constexpr bool operator==(const AtlasSquare&, const AtlasSquare&) = default;
};

struct SquareAtlas {
  std::uint32_t side = 0;  // a power of two
  std::vector<AtlasSquare> squares;
};

// Squares of the given sides, powers of two from 16 on, that do not overlap, in their order. The atlas has less than
// four times their area. If it is larger than wanted, a power of two from 16 on, all sides are halved down to 16 until
// it is not. Sorts them.
[[nodiscard]] SquareAtlas pack_squares(std::vector<std::uint32_t> sides, std::uint32_t wanted);

// All values zero.
[[nodiscard]] LinearImage blank_image(const SquareAtlas& atlas, std::uint32_t channels);
// Both images have as many channels; the first is symmetric, of square.image() texels along a side. Pastes into
// different squares may run side by side.
void paste(const LinearImage& image, const AtlasSquare& square, LinearImage& atlas);
// The mean of all squares for texels in none, so that levels do not mix them with the background.
void fill_rest(const SquareAtlas& squares, LinearImage& atlas);
// The image of a square, without its margin.
[[nodiscard]] LinearImage cut_out(const LinearImage& atlas, const AtlasSquare& square);

[[nodiscard]] OctahedralLayout layout_of(const SquareAtlas& atlas);
// The squares in an image of n texels along a side, in the order of the layout: those of at least 8 texels there.
[[nodiscard]] std::vector<AtlasSquare> squares_of(const OctahedralLayout& layout, std::uint32_t n);

// Makes the margins of an atlas continue its images again that a lossy code has altered, whatever its values encode.
// `values` has n rows of n texels of `channels` values.
template <class Value>
void continue_squares(std::span<Value> values, std::uint32_t n, std::size_t channels, const OctahedralLayout& layout) {
  for (const AtlasSquare& square : squares_of(layout, n)) {
    const std::int64_t side = square.side, margin = square.margin(), inner = square.image();
    const auto index = [&](std::int64_t x, std::int64_t y) {
      return (static_cast<std::size_t>(square.y + y) * n + static_cast<std::size_t>(square.x + x)) * channels;
    };
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t x = 0; x < side; ++x) {
        const Texel at{x - margin, y - margin}, from = continued(at, inner);
        if (from == at) continue;
        for (std::size_t c = 0; c < channels; ++c)
          values[index(x, y) + c] = values[index(from.x + margin, from.y + margin) + c];
      }
  }
}

// The place of a component's octahedral square in its texture.
struct ImagePlace {
  std::uint32_t material = 0;
  SquarePoint origin;
  double scale = 1;
  std::uint32_t side = 0;  // of the square: pixels
  [[nodiscard]] SquarePoint of(SquarePoint p) const { return {origin.s + scale * p.s, origin.t + scale * p.t}; }
};
[[nodiscard]] ImagePlace place_in(const SquareAtlas& atlas, std::size_t square, std::uint32_t material);

}  // namespace lodestone::spherical
