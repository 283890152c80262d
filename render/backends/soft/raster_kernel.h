// Stage 3, a lane per pixel: which samples of a tile a triangle covers (pineda1988), in exact integer arithmetic.
//
// A sample is covered when it lies inside the triangle, or on an edge that is a top or a left one. An edge that two
// triangles share is top-left for exactly one of them: along it no sample is drawn twice and none is missed.
#pragma once

#include "render/backends/soft/kernels.h"
#include "render/surface/lanes.h"

namespace lodestone::soft::LODESTONE_LANES {

// An edge from a to b in a tile. Sums of steps over pixels are multiples of 256, so the sign of the edge function at a
// sample is that of its floor over 256: 32 bits suffice for triangles of any size. Values out of range are clamped to
// where no sum of steps within a tile changes the sign.
struct TileEdge {
  std::int64_t exact;           // at the first pixel of the tile
  std::int64_t dx, dy;          // b - a, subpixels: the function grows by dx per subpixel downwards, -dy to the right
  std::int32_t bias;            // 0 for top and left edges, -1 for others: makes "> 0" a ">= 0"
  std::int32_t step_x, step_y;  // of the scaled function, per pixel

  TileEdge(SnappedPoint a, SnappedPoint b, PixelRect rect)
      : dx(b.x - a.x),
        dy(b.y - a.y),
        bias(dy < 0 || (dy == 0 && dx > 0) ? 0 : -1),
        step_x(static_cast<std::int32_t>(-dy)),
        step_y(static_cast<std::int32_t>(dx)) {
    constexpr int half = subpixels / 2;
    exact = dx * (rect.y0 * subpixels + half - a.y) - dy * (rect.x0 * subpixels + half - a.x);
  }
  // Value at a sample of the first pixel.
  [[nodiscard]] std::int64_t at(SnappedPoint offset) const { return exact + dx * offset.y - dy * offset.x; }
  [[nodiscard]] std::int32_t scaled(SnappedPoint offset) const {
    constexpr std::int64_t limit = 1 << 30;
    const std::int64_t value = (at(offset) + bias) >> subpixel_bits;
    return static_cast<std::int32_t>(value < -limit ? -limit : value > limit ? limit : value);
  }
};

// Pixels of the tile with a sample in the triangle's closed bounding box, counted from the tile's first.
template <int Samples>
inline PixelRect box_in_tile(const TriangleRecord& t, PixelRect rect) {
  constexpr int first = subpixels / 2 - sample_reach<Samples>, last = subpixels / 2 + sample_reach<Samples>;
  const auto [x_lo, x_hi] = std::minmax({t.corners[0].x, t.corners[1].x, t.corners[2].x});
  const auto [y_lo, y_hi] = std::minmax({t.corners[0].y, t.corners[1].y, t.corners[2].y});
  return {std::max(((x_lo + (subpixels - 1 - last)) >> subpixel_bits) - rect.x0, 0),
          std::max(((y_lo + (subpixels - 1 - last)) >> subpixel_bits) - rect.y0, 0),
          std::min((((x_hi - first) >> subpixel_bits) + 1) - rect.x0, rect.x1 - rect.x0),
          std::min((((y_hi - first) >> subpixel_bits) + 1) - rect.y0, rect.y1 - rect.y0)};
}

// In and around a bounding box of 2^14 subpixels edge functions stay below 2^31 all over a tile.
inline bool is_narrow(const TriangleRecord& t) {
  const auto [left, right] = std::minmax({t.corners[0].x, t.corners[1].x, t.corners[2].x});
  const auto [top, bottom] = std::minmax({t.corners[0].y, t.corners[1].y, t.corners[2].y});
  return right - left <= 1 << 14 && bottom - top <= 1 << 14;
}

// Narrow: edge functions are kept as they are, in 32 bits. Others: scaled for coverage, in double for depth.
template <int Samples, bool Narrow>
class TriangleInTile {
 public:
  TriangleInTile(const TriangleRecord& t, PixelRect rect)
      : t_(t),
        box_(box_in_tile<Samples>(t, rect)),
        edges_{TileEdge(t.corners[0], t.corners[1], rect), TileEdge(t.corners[1], t.corners[2], rect),
               TileEdge(t.corners[2], t.corners[0], rect)},
        inverse_area_(1 / static_cast<float>(edges_[0].dx * (t.corners[2].y - t.corners[0].y) -
                                             edges_[0].dy * (t.corners[2].x - t.corners[0].x))) {
    for (std::size_t i = 0; i < 3; ++i) {
      const TileEdge& e = edges_[i];
      step_x_[i] = Narrow ? e.step_x * subpixels : e.step_x;
      step_y_[i] = Narrow ? e.step_y * subpixels : e.step_y;
      reach_[i] = (block_size - 1) * (std::max(step_x_[i], 0) + std::max(step_y_[i], 0));
      for (std::size_t s = 0; s < Samples; ++s) {
        const SnappedPoint offset = sample_offsets<Samples>[s];
        origin_[s][i] = Narrow ? static_cast<std::int32_t>(e.at(offset)) + e.bias : e.scaled(offset);
      }
    }
  }

  // Gives the covered samples to the target, by blocks of 8x8 pixels: see DepthTarget.
  template <class Target>
  void draw(Target& target) const {
    for (int y = box_.y0 & -block_size; y < box_.y1; y += block_size)
      for (int x = box_.x0 & -block_size; x < box_.x1; x += block_size) {
        if (target.skips(x, y)) continue;
        bool changed = false;
        for (std::size_t s = 0; s < Samples; ++s) changed |= draw_block(target, x, y, s);
        if (changed) target.changed(x, y);
      }
  }

  // Depths of the lanes at (x, y), whose edge functions are ab and ca; by shares, as for small triangles
  // (setup_kernel.h).
  [[nodiscard]] Float depths(int x, int y, std::size_t s, Int ab, Int ca) const {
    const Float share_b = share(edges_[2], ca, x, y, s), share_c = share(edges_[0], ab, x, y, s);
    return max((t_.z[0] + share_b * (t_.z[1] - t_.z[0])) + share_c * (t_.z[2] - t_.z[0]), all(0.0f));
  }

 private:
  static constexpr int block_size = TileBuffer<Samples>::block_size;

  template <class Target>
  bool draw_block(Target& target, int x, int y, std::size_t s) const {
    const int first = std::max(y, box_.y0), last = std::min(y + block_size, box_.y1);
    std::int32_t start[3];  // at (x, first)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t corner = origin_[s][i] + step_x_[i] * x + step_y_[i] * y;
      if (corner + reach_[i] < 0) return false;
      start[i] = corner + step_y_[i] * (first - y);
    }
    bool changed = false;
    for (int column = x; column < x + block_size; column += width) {
      const Int right = iota() + (column - x);
      Int ab = start[0] + step_x_[0] * right, bc = start[1] + step_x_[1] * right, ca = start[2] + step_x_[2] * right;
      for (int row = first; row < last; ++row) {
        const Int inside = (ab | bc | ca) >= 0;
        if (bits(inside)) changed |= target.cover(*this, column, row, s, inside, ab, ca);
        ab += step_y_[0], bc += step_y_[1], ca += step_y_[2];
      }
    }
    return changed;
  }

  // Share of corner c or b, by the edge opposite to it, whose value in these pixels is `value` where that is exact.
  [[nodiscard]] Float share(const TileEdge& e, Int value, int x, int y, std::size_t s) const {
    if constexpr (Narrow) return to_float(value - e.bias) * inverse_area_;
    const std::int64_t start = e.at(sample_offsets<Samples>[s]) + (e.dx * y - e.dy * x) * subpixels;
    const Double exact =
        all(static_cast<double>(start)) + all(static_cast<double>(-e.dy * subpixels)) * to_double(iota());
    return to_float(exact) * inverse_area_;
  }

  const TriangleRecord& t_;
  PixelRect box_;
  TileEdge edges_[3];  // ab, bc, ca
  std::int32_t step_x_[3], step_y_[3], reach_[3];
  std::int32_t origin_[Samples][3];  // biased, at the samples of the tile's first pixel
  float inverse_area_;
};

template <int Samples, class Target>
inline void draw_record(const TriangleRecord& t, PixelRect rect, Target& target) {
  if (is_narrow(t)) {
    TriangleInTile<Samples, true>(t, rect).draw(target);
  } else {
    TriangleInTile<Samples, false>(t, rect).draw(target);
  }
}

// Visibility: the nearest triangle is kept.
template <int Samples>
class DepthTarget {
 public:
  DepthTarget(const TriangleRecord& t, std::uint32_t reference, TileBuffer<Samples>& tile)
      : triangle_(t.triangle), reference_(reference), nearest_(std::min({t.z[0], t.z[1], t.z[2]})), tile_(tile) {}

  // True if all of the triangle is hidden in the block at (x, y). Interpolated depth may be nearer than the nearest
  // corner by a few roundings.
  [[nodiscard]] bool skips(int x, int y) const { return nearest_ - 4e-7f > tile_.farthest[block(x, y)]; }

  // Samples s of pixels from (x, y) on, in the lanes of `inside`; has anything changed?
  template <class TriangleInThisTile>
  bool cover(const TriangleInThisTile& t, int x, int y, std::size_t s, Int inside, Int ab, Int ca) {
    const Float z = t.depths(x, y, s, ab, ca);
    const std::size_t at = s * tile_pixels + static_cast<std::size_t>(y * tile_size + x);
    const Float old_z = load<Float>(&tile_.depth[at]);
    Int wins = inside & (z < old_z);
    if (const unsigned ties = bits(inside & (z == old_z))) wins |= earlier(ties, at);
    if (bits(wins) == 0) return false;
    store(&tile_.depth[at], select(wins, z, old_z));
    const Int own = all(static_cast<std::int32_t>(reference_));
    store(&tile_.reference[at], select(wins, own, load<Int>(&tile_.reference[at])));
    return true;
  }

  void changed(int x, int y) {
    const std::size_t number = block(x, y);
    if (++tile_.changes[number] == refresh_after) refresh(x, y, number);
  }

 private:
  static constexpr int block_size = TileBuffer<Samples>::block_size;
  // Looking at a block costs about as much as drawing a few small triangles in it.
  static constexpr std::uint8_t refresh_after = 8;

  static std::size_t block(int x, int y) {
    return static_cast<std::size_t>((y / block_size) * TileBuffer<Samples>::blocks_per_row + x / block_size);
  }

  // The lanes of `ties` whose triangle is drawn later than this one. Nothing is drawn at the background's depth.
  [[nodiscard]] Int earlier(unsigned ties, std::size_t at) const {
    Int mask = all(0);
    for (int k = 0; k < width; ++k)
      if (ties >> k & 1 && tile_.depth[at + static_cast<std::size_t>(k)] < 1)
        mask[k] = -(triangle_ < tile_.sources.triangle(tile_.reference[at + static_cast<std::size_t>(k)]));
    return mask;
  }

  void refresh(int x, int y, std::size_t number) {
    Float far = all(0.0f);
    for (std::size_t s = 0; s < Samples; ++s)
      for (int row = y; row < y + block_size; ++row)
        for (int column = x; column < x + block_size; column += width)
          far =
              max(far, load<Float>(&tile_.depth[s * tile_pixels + static_cast<std::size_t>(row * tile_size + column)]));
    float farthest = 0;
    for (int k = 0; k < width; ++k) farthest = std::max(farthest, static_cast<float>(far[k]));
    tile_.farthest[number] = farthest;
    tile_.changes[number] = 0;
  }

  TriangleNumber triangle_;
  std::uint32_t reference_;
  float nearest_;
  TileBuffer<Samples>& tile_;
};

template <int Samples>
void draw_triangles(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect,
                    TileBuffer<Samples>& tile) {
  std::uint32_t own = Reference::record_bit | Reference::first_of_run(tile.sources.record_runs.size());
  tile.sources.record_runs.push_back(first);
  for (const TriangleRecord* t = first; t != last; ++t, ++own) {
    DepthTarget<Samples> target(*t, own, tile);
    draw_record<Samples>(*t, rect, target);
  }
}

// Counts the triangles that cover each sample.
class CountTarget {
 public:
  explicit CountTarget(std::int32_t* counts) : counts_(counts) {}
  [[nodiscard]] static bool skips(int, int) { return false; }
  static void changed(int, int) {}

  template <class TriangleInThisTile>
  bool cover(const TriangleInThisTile&, int x, int y, std::size_t s, Int inside, Int, Int) {
    std::int32_t* at = counts_ + s * tile_pixels + static_cast<std::size_t>(y * tile_size + x);
    store(at, load<Int>(at) - inside);
    return false;
  }

 private:
  std::int32_t* counts_;
};

template <int Samples>
void count_triangles(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect, std::int32_t* counts) {
  CountTarget target(counts);
  for (const TriangleRecord* t = first; t != last; ++t) draw_record<Samples>(*t, rect, target);
}

}  // namespace lodestone::soft::LODESTONE_LANES
