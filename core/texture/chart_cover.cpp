#include "core/texture/chart_cover.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/texture/texel_wrap.h"

namespace lodestone {
namespace {

class Cover {
 public:
  Cover(PixelSize size, TextureWrap wrap_u, TextureWrap wrap_v)
      : size_(size), wrap_u_(wrap_u), wrap_v_(wrap_v), covered(std::size_t{size.width} * size.height) {}

  // Returns the number of centres within.
  std::size_t add(const ChartTriangle& triangle);
  void add_barycentre(const ChartTriangle& triangle) {
    TexelPoint sum;
    for (const TexelPoint p : texel_points(triangle.uv, size_)) sum = {sum.x + p.x / 3, sum.y + p.y / 3};
    set(std::llround(sum.x), std::llround(sum.x), std::llround(sum.y));
  }

 private:
  void set(std::int64_t left, std::int64_t right, std::int64_t y) {
    std::uint8_t* const row = &covered[std::size_t{wrapped(y, size_.height, wrap_v_)} * size_.width];
    if (left >= 0 && right < size_.width)
      std::fill(row + left, row + right + 1, std::uint8_t{1});
    else
      for (std::int64_t x = left; x <= right; ++x) row[wrapped(x, size_.width, wrap_u_)] = 1;
  }

  PixelSize size_;
  TextureWrap wrap_u_, wrap_v_;

 public:
  std::vector<std::uint8_t> covered;
};

std::size_t Cover::add(const ChartTriangle& triangle) {
  const std::array<TexelPoint, 3> p = texel_points(triangle.uv, size_);
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  // A triangle over several repetitions of the image: it uses all of it, or nearly so.
  if (!(right - left < 2.0 * size_.width && bottom - top < 2.0 * size_.height)) {
    std::ranges::fill(covered, std::uint8_t{1});
    return covered.size();
  }
  std::size_t count = 0;
  for_each_row(p, [&](std::int64_t first, std::int64_t last, std::int64_t y) {
    set(first, last, y);
    count += static_cast<std::size_t>(last - first + 1);
  });
  return count;
}

}  // namespace

std::vector<std::uint8_t> chart_cover(std::span<const ChartTriangle> triangles, PixelSize size, TextureWrap wrap_u,
                                      TextureWrap wrap_v) {
  Cover cover(size, wrap_u, wrap_v);
  std::unordered_map<std::uint32_t, std::size_t> centres;  // by chart
  for (const ChartTriangle& triangle : triangles) centres[triangle.chart] += cover.add(triangle);
  for (const ChartTriangle& triangle : triangles)
    if (centres[triangle.chart] == 0) cover.add_barycentre(triangle);
  return std::move(cover.covered);
}

}  // namespace lodestone
