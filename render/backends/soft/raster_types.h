// Plain data that the stages of the software rasterizer hand to each other.
//
// Window coordinates have their origin at the upper left corner of the picture, y down, and are snapped to 1/256 pixel:
// from there on coverage is a matter of integers.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec3.h"
#include "render/camera.h"

namespace lodestone::soft {

inline constexpr int subpixel_bits = 8;
inline constexpr int subpixels = 1 << subpixel_bits;
inline constexpr int tile_size = 64;  // pixels, both ways
// Triangles are clipped only where they reach farther than this beyond the picture: the rest is cut by its tiles.
inline constexpr float guard_pixels = 4096;
inline constexpr int largest_side = 16384;  // of a picture: snapped coordinates stay below 2^23, exact in float

// Half-open range of pixels.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// A transformed vertex, in the window.
struct WindowVertex {
  std::int32_t x = 0, y = 0;  // subpixels; meaningless when the outcode has needs_clipping
  float z = 0;                // window depth, [0, 1]
  float inverse_w = 0;        // 1 / clip w, for perspective-correct interpolation
  Vec3f normal;               // normalised model space, about unit length
  std::uint32_t outcode = 0;
};

// Bits of an outcode: outside the left, right, bottom, top, near, far plane.
inline constexpr std::uint32_t outside_any = 0x3f;
// Near or far plane, or beyond the guard band: the triangle must be clipped before it can be snapped.
inline constexpr std::uint32_t needs_clipping = 0x40;

// A triangle that covers a pixel centre of a tile, perhaps.
struct TriangleRef {
  std::uint32_t v[3] = {};  // index in the frame's vertices; with `clipped_bit` in its batch's own clipped vertices
  std::uint32_t tag = 0;    // batch << 4 | level

  [[nodiscard]] std::uint32_t batch() const { return tag >> 4; }
  [[nodiscard]] int level() const { return static_cast<int>(tag & 0xf); }
};
inline constexpr std::uint32_t clipped_bit = 0x8000'0000u;

// The triangles of a batch of consecutive cells, sorted by tile and within a tile in drawing order.
struct Batch {
  std::vector<TriangleRef> triangles;
  std::vector<std::uint32_t> tile_begin;  // one per tile and one more: range in `triangles`
  std::vector<WindowVertex> clipped;
};

struct TileGrid {
  ImageSize size;
  int columns = 0, rows = 0;

  explicit TileGrid(ImageSize s = {0, 0})
      : size(s), columns((s.width + tile_size - 1) / tile_size), rows((s.height + tile_size - 1) / tile_size) {}
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  [[nodiscard]] PixelRect rect(std::size_t tile) const {
    const int left = static_cast<int>(tile) % columns * tile_size, top = static_cast<int>(tile) / columns * tile_size;
    return {left, top, left + tile_size < size.width ? left + tile_size : size.width,
            top + tile_size < size.height ? top + tile_size : size.height};
  }
};

}  // namespace lodestone::soft
