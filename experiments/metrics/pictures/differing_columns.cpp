#include "experiments/metrics/pictures/differing_columns.h"

#include <algorithm>
#include <cstdint>

namespace lodestone {
namespace {

Columns differing(const std::uint8_t* a, const std::uint8_t* b, std::size_t width) {
  const auto differs = [&](std::size_t x) {
    const std::size_t i = 4 * x;
    return a[i] != b[i] || a[i + 1] != b[i + 1] || a[i + 2] != b[i + 2];
  };
  Columns columns{0, width};
  while (columns.begin < width && !differs(columns.begin)) ++columns.begin;
  if (columns.begin == width) return {};
  while (!differs(columns.end - 1)) --columns.end;
  return columns;
}

}  // namespace

DifferingColumns::DifferingColumns(const Image& a, const Image& b) : width_(static_cast<std::size_t>(a.size.width)) {
  const auto height = static_cast<std::size_t>(a.size.height);
  rows_.reserve(height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t first = 4 * y * width_;
    rows_.push_back(differing(a.rgba.data() + first, b.rgba.data() + first, width_));
  }
}

Columns DifferingColumns::near(std::size_t y, std::size_t down, std::size_t across) const {
  const std::size_t last = std::min(rows_.size() - 1, y + down);
  Columns all{width_, 0};
  for (std::size_t row = y > down ? y - down : 0; row <= last; ++row) {
    if (rows_[row].size() == 0) continue;
    all.begin = std::min(all.begin, rows_[row].begin);
    all.end = std::max(all.end, rows_[row].end);
  }
  if (all.begin >= all.end) return {};
  return {all.begin > across ? all.begin - across : 0, std::min(width_, all.end + across)};
}

}  // namespace lodestone
