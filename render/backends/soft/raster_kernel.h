// Stage 3, a lane per pixel: which samples of a tile a triangle covers (pineda1988), in exact integer arithmetic.
//
// A sample is covered when it lies inside the triangle, or on an edge that is a top or a left one. An edge that two
// triangles share is top-left for exactly one of them: along it no sample is drawn twice and none is missed.
#pragma once

#include "render/backends/soft/kernels.h"
#include "render/backends/soft/lanes.h"

namespace lodestone::soft::LODESTONE_LANES {

// An edge from a to b in a tile. Sums of steps over pixels are multiples of 256, so the sign of the edge function at a
// sample is that of its floor over 256: 32 bits suffice for triangles of any size. What is out of range is clamped to
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
  // At a sample of the first pixel.
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

template <int Samples>
class TriangleInTile {
 public:
  TriangleInTile(const TriangleRecord& t, std::uint32_t reference, PixelRect rect, TileBuffer<Samples>& tile)
      : t_(t),
        reference_(reference),
        tile_(tile),
        box_(box_in_tile<Samples>(t, rect)),
        ab_(t.corners[0], t.corners[1], rect),
        bc_(t.corners[1], t.corners[2], rect),
        ca_(t.corners[2], t.corners[0], rect),
        inverse_area_(1 / static_cast<float>(ab_.dx * (t.corners[2].y - t.corners[0].y) -
                                             ab_.dy * (t.corners[2].x - t.corners[0].x))),
        nearest_(std::min({t.z[0], t.z[1], t.z[2]})),
        narrow_(is_narrow(t)) {}

  void draw() {
    constexpr int block = TileBuffer<Samples>::block_size;
    for (int y = box_.y0 & -block; y < box_.y1; y += block)
      for (int x = box_.x0 & -block; x < box_.x1; x += block) {
        const std::size_t number =
            static_cast<std::size_t>((y / block) * TileBuffer<Samples>::blocks_per_row + x / block);
        // Interpolated depth may be nearer than the nearest corner by a few roundings.
        if (nearest_ - 4e-7f > tile_.farthest[number]) continue;
        bool changed = false;
        for (std::size_t s = 0; s < Samples; ++s) changed |= draw_block(x, y, s);
        if (changed && ++tile_.changes[number] == refresh_after) refresh(x, y, number);
      }
  }

 private:
  // In and around a bounding box of 2^14 subpixels edge functions stay below 2^30.
  static bool is_narrow(const TriangleRecord& t) {
    const auto [left, right] = std::minmax({t.corners[0].x, t.corners[1].x, t.corners[2].x});
    const auto [top, bottom] = std::minmax({t.corners[0].y, t.corners[1].y, t.corners[2].y});
    return right - left <= 1 << 14 && bottom - top <= 1 << 14;
  }

  // Looking at a block costs about as much as drawing a few small triangles in it.
  static constexpr std::uint8_t refresh_after = 8;

  bool draw_block(int x, int y, std::size_t s) {
    constexpr int block = TileBuffer<Samples>::block_size;
    const SnappedPoint offset = sample_offsets<Samples>[s];
    const auto at = [&](const TileEdge& e) { return e.scaled(offset) + e.step_x * x + e.step_y * y; };
    const std::int32_t ab = at(ab_), bc = at(bc_), ca = at(ca_);
    const auto reaches = [](std::int32_t value, const TileEdge& e) {
      return value + (block - 1) * (std::max(e.step_x, 0) + std::max(e.step_y, 0)) >= 0;
    };
    if (!reaches(ab, ab_) || !reaches(bc, bc_) || !reaches(ca, ca_)) return false;
    bool changed = false;
    const int first = std::max(y, box_.y0), last = std::min(y + block, box_.y1);
    for (int column = x; column < x + block; column += width) {
      const Int right = iota() + (column - x);
      Int e_ab = ab + ab_.step_y * (first - y) + ab_.step_x * right,
          e_bc = bc + bc_.step_y * (first - y) + bc_.step_x * right,
          e_ca = ca + ca_.step_y * (first - y) + ca_.step_x * right;
      for (int row = first; row < last; ++row) {
        const Int inside = (e_ab | e_bc | e_ca) >= 0;
        if (bits(inside)) changed |= draw_lanes(column, row, s, inside);
        e_ab += ab_.step_y, e_bc += bc_.step_y, e_ca += ca_.step_y;
      }
    }
    return changed;
  }

  // An edge function as it is, in `width` pixels: exact in double, and in 32 bits where the triangle is not too large.
  [[nodiscard]] Float edge_values(const TileEdge& e, SnappedPoint offset, int x, int y) const {
    const std::int64_t start = e.at(offset) + (e.dx * y - e.dy * x) * subpixels, step = -e.dy * subpixels;
    if (narrow_) return to_float(static_cast<std::int32_t>(start) + static_cast<std::int32_t>(step) * iota());
    return to_float(all(static_cast<double>(start)) + all(static_cast<double>(step)) * to_double(iota()));
  }

  // Depth by shares, as small triangles have it (setup_kernel.h).
  bool draw_lanes(int x, int y, std::size_t s, Int inside) {
    const SnappedPoint offset = sample_offsets<Samples>[s];
    const auto share = [&](const TileEdge& e) { return edge_values(e, offset, x, y) * inverse_area_; };
    const Float z = max((t_.z[0] + share(ca_) * (t_.z[1] - t_.z[0])) + share(ab_) * (t_.z[2] - t_.z[0]), all(0.0f));
    const std::size_t at = s * tile_pixels + static_cast<std::size_t>(y * tile_size + x);
    const Float old_z = load<Float>(&tile_.depth[at]);
    Int wins = inside & (z < old_z);
    if (const unsigned ties = bits(inside & (z == old_z))) wins |= earlier(ties, at);
    store(&tile_.depth[at], select(wins, z, old_z));
    const Int own = all(static_cast<std::int32_t>(reference_));
    store(&tile_.reference[at], select(wins, own, load<Int>(&tile_.reference[at])));
    return bits(wins) != 0;
  }

  // Of the lanes of `ties` those whose triangle is drawn later than this one. Nothing is drawn at the background's
  // depth.
  [[nodiscard]] Int earlier(unsigned ties, std::size_t at) const {
    Int mask = all(0);
    for (int k = 0; k < width; ++k)
      if (ties >> k & 1 && tile_.depth[at + static_cast<std::size_t>(k)] < 1)
        mask[k] = -(t_.triangle < tile_.sources.triangle(tile_.reference[at + static_cast<std::size_t>(k)]));
    return mask;
  }

  void refresh(int x, int y, std::size_t number) {
    constexpr int block = TileBuffer<Samples>::block_size;
    Float far = all(0.0f);
    for (std::size_t s = 0; s < Samples; ++s)
      for (int row = y; row < y + block; ++row)
        for (int column = x; column < x + block; column += width)
          far =
              max(far, load<Float>(&tile_.depth[s * tile_pixels + static_cast<std::size_t>(row * tile_size + column)]));
    float farthest = 0;
    for (int k = 0; k < width; ++k) farthest = std::max(farthest, static_cast<float>(far[k]));
    tile_.farthest[number] = farthest;
    tile_.changes[number] = 0;
  }

  const TriangleRecord& t_;
  std::uint32_t reference_;
  TileBuffer<Samples>& tile_;
  PixelRect box_;
  TileEdge ab_, bc_, ca_;
  float inverse_area_, nearest_;
  bool narrow_;
};

template <int Samples>
void draw_triangles(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect,
                    TileBuffer<Samples>& tile) {
  std::uint32_t own = Reference::record_bit | Reference::first_of_run(tile.sources.record_runs.size());
  tile.sources.record_runs.push_back(first);
  for (const TriangleRecord* t = first; t != last; ++t, ++own) TriangleInTile<Samples>(*t, own, rect, tile).draw();
}

}  // namespace lodestone::soft::LODESTONE_LANES
