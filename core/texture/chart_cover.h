// Which texels of an image a surface uses, and values for those that it does not use.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/math/vec3.h"
#include "core/mesh/attributes.h"
#include "core/texture/image_codec.h"

namespace lodestone {

struct ChartTriangle {
  std::array<Vec2f, 3> uv;  // as in RawWedges, of either orientation
  std::uint32_t chart = 0;  // any number that triangles of one chart share
};

// Coordinates in which the centres of texels are whole numbers.
struct TexelPoint {
  double x = 0, y = 0;
};
[[nodiscard]] inline std::array<TexelPoint, 3> texel_points(const std::array<Vec2f, 3>& uv, PixelSize size) {
  std::array<TexelPoint, 3> points;
  for (std::size_t k = 0; k < 3; ++k)
    points[k] = {double{uv[k].x} * size.width - 0.5, double{uv[k].y} * size.height - 0.5};
  return points;
}

// Calls body(first, last, y) for the rows of centres that are in the triangle or on its edges.
template <class Body>
void for_each_row(const std::array<TexelPoint, 3>& points, const Body& body) {
  const auto [top, bottom] = std::minmax({points[0].y, points[1].y, points[2].y});
  for (double y = std::ceil(top); y <= bottom; ++y) {
    double left = std::numeric_limits<double>::infinity(), right = -left;
    for (std::size_t k = 0; k < 3; ++k) {
      TexelPoint a = points[k], b = points[(k + 1) % 3];
      if (a.y > b.y) std::swap(a, b);
      if (!(a.y <= y && y <= b.y)) continue;
      const double x = a.y < b.y ? a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)) : a.x;
      left = std::min({left, x, a.y < b.y ? x : b.x}), right = std::max({right, x, a.y < b.y ? x : b.x});
    }
    if (!(left <= right)) continue;
    const auto first = static_cast<std::int64_t>(std::ceil(left)), last = static_cast<std::int64_t>(std::floor(right));
    if (first <= last) body(first, last, static_cast<std::int64_t>(y));
  }
}

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
  const std::size_t width = size.width, height = size.height;
  const auto neighbours = [&](std::size_t texel, const auto& body) {
    const std::size_t y = texel / width, x = texel - y * width;
    const bool is_inner = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        if (i == 0 && j == 0) continue;
        const auto to_x = static_cast<std::int64_t>(x) + i, to_y = static_cast<std::int64_t>(y) + j;
        body(is_inner ? static_cast<std::size_t>(to_y) * width + static_cast<std::size_t>(to_x)
                      : static_cast<std::size_t>(index(to_x, to_y)));
      }
  };
  // Beside covered texels, each once; 2 marks them until their ring is complete.
  std::vector<std::size_t> ring, next, sources;
  std::vector<std::uint8_t> columns(width);  // 1: the texel, the one above or the one below is covered
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* const row = &covered[y * width];
    const bool is_inner = y > 0 && y + 1 < height;
    for (std::size_t x = 0; is_inner && x < width; ++x)
      columns[x] = static_cast<std::uint8_t>(row[x] | (row - width)[x] | (row + width)[x]);
    for (std::size_t x = 0; x < width; ++x) {
      if (row[x] != 0) continue;
      bool beside = false;
      if (is_inner && x > 0 && x + 1 < width)
        beside = (columns[x - 1] | columns[x] | columns[x + 1]) != 0;
      else
        neighbours(y * width + x, [&](std::size_t other) { beside = beside || covered[other] == 1; });
      if (beside) ring.push_back(y * width + x);
    }
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

}  // namespace lodestone
