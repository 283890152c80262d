#include "render/culling/depth_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

// A row of the matrix at a point, and a bound of what float arithmetic may make of it: three products and three sums,
// each off by half a unit in the last place of no more than the sum of the absolute terms.
struct Row {
  double value = 0, error = 0;
};
Row row_at(const ViewProjection& vp, std::size_t row, Vec3f p) {
  constexpr double roundings = 8 * 0x1p-24;
  const double x = double{vp.m[4 * row]} * p.x, y = double{vp.m[4 * row + 1]} * p.y,
               z = double{vp.m[4 * row + 2]} * p.z, w = vp.m[4 * row + 3];
  return {x + y + z + w, roundings * (std::abs(x) + std::abs(y) + std::abs(z) + std::abs(w))};
}

// Smallest and largest value over w, errors included.
struct Span {
  double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();
  void add(Row value, Row w) {
    const double ratio = value.value / w.value;
    const double error = (value.error + std::abs(ratio) * w.error) / (w.value - w.error);
    lo = std::min(lo, ratio - error);
    hi = std::max(hi, ratio + error);
  }
};

// Beyond the transform: division, viewport, and depth interpolated between corners (raster_kernel.h has the same
// guard).
constexpr double depth_guard = 1e-6;
// Snapping, and the reach of samples around the middle of a pixel.
constexpr double pixel_guard = 1;

// Pixel coordinate, clamped far outside the picture.
int pixel(double at, int side) { return static_cast<int>(std::floor(std::clamp(at, -2.0, side + 2.0))); }

}  // namespace

// The ratio of two affine functions is monotone along every line on which the lower one is positive, so that over a box
// it has its minimum and maximum at corners.
std::optional<ScreenBox> screen_box(const ViewProjection& view_projection, const Box3f& box, ImageSize size) {
  Span x, y, z;
  for (int k = 0; k < 8; ++k) {
    const Vec3f p{(k & 1) ? box.hi.x : box.lo.x, (k & 2) ? box.hi.y : box.lo.y, (k & 4) ? box.hi.z : box.lo.z};
    const Row depth = row_at(view_projection, 2, p), w = row_at(view_projection, 3, p);
    if (!(w.value > 2 * w.error) || depth.value < depth.error + w.error - w.value) return std::nullopt;
    x.add(row_at(view_projection, 0, p), w);
    y.add(row_at(view_projection, 1, p), w);
    z.add(depth, w);
  }
  ScreenBox out;
  out.x0 = std::max(pixel(0.5 * (1 + x.lo) * size.width - pixel_guard, size.width), 0);
  out.x1 = std::min(pixel(0.5 * (1 + x.hi) * size.width + pixel_guard, size.width), size.width - 1);
  out.y0 = std::max(pixel(0.5 * (1 - y.hi) * size.height - pixel_guard, size.height), 0);
  out.y1 = std::min(pixel(0.5 * (1 - y.lo) * size.height + pixel_guard, size.height), size.height - 1);
  out.nearest = static_cast<float>(std::clamp(0.5 + 0.5 * z.lo - depth_guard, 0.0, 1.0));
  return out;
}

void DepthPyramid::reset(ImageSize size) {
  int columns = (size.width + block_size - 1) / block_size, rows = (size.height + block_size - 1) / block_size;
  std::size_t count = 0;
  while (true) {
    if (levels_.size() <= count) levels_.emplace_back();
    Level& level = levels_[count++];
    level.columns = columns;
    level.rows = rows;
    level.farthest.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 1.0f);
    if (columns == 1 && rows == 1) break;
    columns = (columns + 1) / 2;
    rows = (rows + 1) / 2;
  }
  levels_.resize(count);
}

void DepthPyramid::build() {
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    const Level& fine = levels_[l - 1];
    Level& coarse = levels_[l];
    std::fill(coarse.farthest.begin(), coarse.farthest.end(), 0.0f);
    for (int y = 0; y < fine.rows; ++y)
      for (int x = 0; x < fine.columns; ++x) {
        float& far = coarse.farthest[static_cast<std::size_t>((y / 2) * coarse.columns + x / 2)];
        far = std::max(far, fine.farthest[static_cast<std::size_t>(y * fine.columns + x)]);
      }
  }
}

// Descends only if a coarse block does not decide. A surface equally far is not hidden: of two surfaces at one depth
// either may win.
bool DepthPyramid::nearer(std::size_t level, int x, int y, const Range& finest, float depth) const {
  const Level& l = levels_[level];
  if (l.farthest[static_cast<std::size_t>(y * l.columns + x)] < depth) return true;
  if (level == 0) return false;
  const auto below = static_cast<int>(level) - 1;
  for (int j = std::max(2 * y, finest.y0 >> below); j <= std::min(2 * y + 1, finest.y1 >> below); ++j)
    for (int i = std::max(2 * x, finest.x0 >> below); i <= std::min(2 * x + 1, finest.x1 >> below); ++i)
      if (!nearer(level - 1, i, j, finest, depth)) return false;
  return true;
}

bool DepthPyramid::hides(const ScreenBox& box) const {
  if (box.x0 > box.x1 || box.y0 > box.y1) return true;
  const Range finest{box.x0 / block_size, box.y0 / block_size, box.x1 / block_size, box.y1 / block_size};
  return nearer(levels_.size() - 1, 0, 0, finest, box.nearest);
}

void fill_blocks(std::span<const float> depth, ImageSize size, DepthPyramid& pyramid) {
  const std::span<float> blocks = pyramid.blocks();
  std::fill(blocks.begin(), blocks.end(), 0.0f);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      float& far = blocks[static_cast<std::size_t>((y / DepthPyramid::block_size) * pyramid.columns() +
                                                   x / DepthPyramid::block_size)];
      far = std::max(
          far, depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x)]);
    }
}

}  // namespace lodestone
