#include "core/spherical/octahedron/square_atlas.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>

namespace lodestone::spherical {
namespace {

// Every second bit, from the first on.
std::uint32_t every_second_bit(std::uint64_t code) {
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < 32; ++k) bits |= static_cast<std::uint32_t>(code >> (2 * k) & 1u) << k;
  return bits;
}

std::size_t texel_at(const LinearImage& image, std::size_t x, std::size_t y) {
  return (y * image.size.width + x) * image.channels;
}

// Along a Morton curve, larger ones first: each begins at a multiple of its own area, and is a square of the curve.
SquareAtlas packed(std::span<const std::uint32_t> sides) {
  std::vector<std::size_t> order(sides.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t k) { return sides[k]; });
  SquareAtlas atlas{AtlasSquare::least_side, std::vector<AtlasSquare>(sides.size())};
  std::uint64_t texels = 0;
  for (const std::size_t k : order) {
    atlas.squares[k] = {every_second_bit(texels), every_second_bit(texels >> 1), sides[k]};
    texels += std::uint64_t{sides[k]} * sides[k];
  }
  while (std::uint64_t{atlas.side} * atlas.side < texels) atlas.side *= 2;
  return atlas;
}

}  // namespace

SquareAtlas pack_squares(std::vector<std::uint32_t> sides, std::uint32_t wanted) {
  for (;;) {
    SquareAtlas atlas = packed(sides);
    if (atlas.side <= wanted || std::ranges::max(sides) <= AtlasSquare::least_side) return atlas;
    for (std::uint32_t& side : sides) side = std::max(side / 2, AtlasSquare::least_side);
  }
}

LinearImage blank_image(const SquareAtlas& atlas, std::uint32_t channels) {
  return {{atlas.side, atlas.side}, channels, std::vector<float>(std::size_t{channels} * atlas.side * atlas.side)};
}

void paste(const LinearImage& image, const AtlasSquare& square, LinearImage& atlas) {
  const auto n = static_cast<std::int64_t>(square.image()), margin = static_cast<std::int64_t>(square.margin());
  for (std::int64_t y = 0; y < square.side; ++y)
    for (std::int64_t x = 0; x < square.side; ++x) {
      const Texel from = continued({x - margin, y - margin}, n);
      const std::size_t to =
          texel_at(atlas, square.x + static_cast<std::size_t>(x), square.y + static_cast<std::size_t>(y));
      std::copy_n(&image.values[texel_at(image, static_cast<std::size_t>(from.x), static_cast<std::size_t>(from.y))],
                  image.channels, &atlas.values[to]);
    }
}

void fill_rest(const SquareAtlas& squares, LinearImage& atlas) {
  std::vector<std::uint8_t> used(std::size_t{atlas.size.width} * atlas.size.height);
  for (const AtlasSquare& square : squares.squares)
    for (std::size_t y = square.y; y < square.y + square.side; ++y)
      std::fill_n(&used[y * atlas.size.width + square.x], square.side, std::uint8_t{1});
  std::array<double, 4> sum{};
  double count = 0;
  for (std::size_t p = 0; p < used.size(); ++p) {
    count += used[p];
    for (std::size_t c = 0; c < atlas.channels; ++c) sum[c] += used[p] * double{atlas.values[p * atlas.channels + c]};
  }
  for (std::size_t p = 0; p < used.size(); ++p)
    for (std::size_t c = 0; c < atlas.channels && used[p] == 0; ++c)
      atlas.values[p * atlas.channels + c] = static_cast<float>(sum[c] / count);
}

LinearImage cut_out(const LinearImage& atlas, const AtlasSquare& square) {
  const std::uint32_t n = square.image();
  LinearImage image{{n, n}, atlas.channels, {}};
  for (std::uint32_t y = 0; y < n; ++y) {
    const float* const row = &atlas.values[texel_at(atlas, square.x + square.margin(), square.y + square.margin() + y)];
    image.values.insert(image.values.end(), row, row + std::size_t{n} * atlas.channels);
  }
  return image;
}

OctahedralLayout layout_of(const SquareAtlas& atlas) {
  std::map<std::uint32_t, std::uint32_t, std::greater<>> counts;
  for (const AtlasSquare& square : atlas.squares) ++counts[square.side];
  OctahedralLayout layout{atlas.side, {}};
  for (const auto& [side, count] : counts) layout.squares.push_back({side, count});
  return layout;
}

std::vector<AtlasSquare> squares_of(const OctahedralLayout& layout, std::uint32_t n) {
  std::vector<AtlasSquare> squares;
  std::uint64_t texels = 0;
  const auto scaled = [&](std::uint32_t length) {
    return static_cast<std::uint32_t>(std::uint64_t{length} * n / layout.side);
  };
  for (const SquareRun& run : layout.squares)
    for (std::uint32_t k = 0; k < run.count && scaled(run.side) >= 8; ++k) {
      squares.push_back({scaled(every_second_bit(texels)), scaled(every_second_bit(texels >> 1)), scaled(run.side)});
      texels += std::uint64_t{run.side} * run.side;
    }
  return squares;
}

ImagePlace place_in(const SquareAtlas& atlas, std::size_t square, std::uint32_t material) {
  const AtlasSquare& at = atlas.squares[square];
  const double texel = 1.0 / atlas.side;
  return {material, {texel * (at.x + at.margin()), texel * (at.y + at.margin())}, texel * at.image(), at.image()};
}

}  // namespace lodestone::spherical
