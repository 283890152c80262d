// Which texels of an image a surface uses, and values for those that it does not use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec2.h"
#include "core/mesh/attributes.h"
#include "core/texture/image_codec.h"

namespace lodestone::spherical {

struct ChartTriangle {
  std::array<Vec2f, 3> uv;  // as in RawWedges, of either orientation
  std::uint32_t chart = 0;  // any number that triangles of one chart share
};

// One byte per texel, row by row: 1 if the centre of the texel is in a triangle, else 0. A chart without any centre
// gets the texels that the barycentres of its triangles are in. Other texels at the border of a chart are left out,
// although a part of them is within: images often have the background there.
[[nodiscard]] std::vector<std::uint8_t> chart_cover(std::span<const ChartTriangle> triangles, PixelSize size,
                                                    TextureWrap wrap_u, TextureWrap wrap_v);

// Extends the covered texels by rings: each texel beside covered ones gets their mean. index(x, y) is the number of the
// texel at x and y from -1 to the size; mean(texels, to) sets one texel to the mean of others. Returns the number of
// rings made: `rings`, or fewer if none was left to make.
template <class Index, class Mean>
std::size_t extend_cover(std::span<std::uint8_t> covered, PixelSize size, std::size_t rings, const Index& index,
                         const Mean& mean) {
  const auto neighbours = [&](std::size_t texel, const auto& body) {
    const auto x = static_cast<std::int64_t>(texel % size.width), y = static_cast<std::int64_t>(texel / size.width);
    for (std::int64_t j = y - 1; j <= y + 1; ++j)
      for (std::int64_t i = x - 1; i <= x + 1; ++i)
        if (i != x || j != y) body(static_cast<std::size_t>(index(i, j)));
  };
  // Beside covered texels, each once; 2 marks them until their ring is complete.
  std::vector<std::size_t> ring, next, sources;
  for (std::size_t texel = 0; texel < covered.size(); ++texel) {
    if (covered[texel] != 0) continue;
    bool beside = false;
    neighbours(texel, [&](std::size_t other) { beside = beside || covered[other] == 1; });
    if (beside) ring.push_back(texel);
  }
  std::size_t made = 0;
  for (; made < rings && !ring.empty(); ++made) {
    for (const std::size_t texel : ring) {
      sources.clear();
      neighbours(texel, [&](std::size_t other) {
        if (covered[other] == 1) sources.push_back(other);
      });
      mean(std::span<const std::size_t>(sources), texel);
    }
    for (const std::size_t texel : ring) covered[texel] = 1;
    next.clear();
    for (const std::size_t texel : ring)
      neighbours(texel, [&](std::size_t other) {
        if (covered[other] != 0) return;
        covered[other] = 2;
        next.push_back(other);
      });
    for (const std::size_t texel : next) covered[texel] = 0;
    ring.swap(next);
  }
  return made;
}

}  // namespace lodestone::spherical
