// Plain data that the stages of the software rasterizer hand to each other.
//
// Window coordinates have their origin at the upper left corner of the picture, y down, and are snapped to 1/256 pixel:
// from there on coverage is a matter of integers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "render/surface/shading_job.h"

namespace lodestone::soft {

inline constexpr int tile_bits = 6;
inline constexpr int tile_size = 1 << tile_bits;  // pixels, both ways
inline constexpr std::size_t tile_pixels = std::size_t{tile_size} * tile_size;
// Triangles are clipped only where they reach farther than this beyond the picture: the rest is cut by its tiles.
inline constexpr float guard_pixels = 4096;
// Maximum side of a picture. Snapped coordinates remain below 2^23: exact in float, and products of their differences
// in double.
inline constexpr int largest_side = 16384;

struct SnappedPoint {
  std::int32_t x = 0, y = 0;  // subpixels
  friend bool operator==(const SnappedPoint&, const SnappedPoint&) = default;
};

// Offsets of a pixel's samples from its centre, in subpixels. Four: the rotated grid that OpenGL drivers use, y down.
template <int Samples>
inline constexpr std::array<SnappedPoint, static_cast<std::size_t>(Samples)> sample_offsets{};
template <>
inline constexpr std::array<SnappedPoint, 4> sample_offsets<4>{{{-32, 96}, {96, 32}, {-96, -32}, {32, -96}}};
// The largest of their coordinates.
template <int Samples>
inline constexpr int sample_reach = Samples == 1 ? 0 : 96;

// Half-open range of pixels.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// A transformed vertex, in the window. One that must be clipped before it can be snapped has inverse_w = 0 and its
// outcode in x.
struct alignas(16) WindowVertex {
  std::int32_t x = 0, y = 0;  // subpixels
  float z = 0;                // window depth, [0, 1]
  float inverse_w = 0;        // 1 / clip w, for perspective-correct interpolation
};

// Bits of an outcode: outside the left, right, bottom, top, near, far plane; behind the clipping plane.
struct Outside {
  static constexpr std::uint32_t left = 1, right = 2, bottom = 4, top = 8, near = 16, far = 32, clip = 64;
};

// The drawn cells, by the numbers of their triangles.
struct DrawnCells {
  std::span<const DrawnCell> cells;
  std::span<const std::uint32_t> cell_of_block;  // by triangle number >> numbers_per_block_bits

  [[nodiscard]] const DrawnCell& cell_of(TriangleNumber triangle) const {
    return cells[cell_of_block[triangle >> numbers_per_block_bits]];
  }
};

using VertexIds = std::array<std::uint32_t, 3>;  // in the cell

// A sample that a small triangle covers, and its place on it: all that shading needs, so that nothing else of the
// triangle is read again.
struct alignas(32) Fragment {
  std::uint32_t sample = 0;  // in its tile: sample * tile_pixels + pixel
  float z = 0;
  TriangleNumber triangle = 0;
  VertexIds v{};
  float weight_b = 0, weight_c = 0;  // of the second and third corner, perspective-correct; the three sum to 1
};

// A larger triangle, ready to be drawn in a tile. Corners turn clockwise in the picture: positive area. If the triangle
// was clipped, corners are those of the remaining part, vertices those of the whole, and inverse_w is 0.
struct alignas(64) TriangleRecord {
  std::array<SnappedPoint, 3> corners;
  std::array<float, 3> z{}, inverse_w{};
  VertexIds v{};
  TriangleNumber triangle = 0;
};

struct TileGrid {
  ImageSize size;
  int columns = 0, rows = 0;

  explicit TileGrid(ImageSize s = {0, 0})
      : size(s), columns((s.width + tile_size - 1) / tile_size), rows((s.height + tile_size - 1) / tile_size) {}
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  [[nodiscard]] PixelRect rect(std::size_t tile) const {
    const int x = static_cast<int>(tile) % columns * tile_size, y = static_cast<int>(tile) / columns * tile_size;
    return {x, y, x + tile_size < size.width ? x + tile_size : size.width,
            y + tile_size < size.height ? y + tile_size : size.height};
  }
};

}  // namespace lodestone::soft
