// A pyramid of the farthest depths of a picture, by blocks of pixels and coarser ones (greene1993), and the place of a
// box in the picture.
//
// All answers err on the side of visible. A hidden box is farther away than the surface in each of its pixels, by more
// than all the roundings of drawing it, so that leaving it out changes no bit of the picture.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "render/camera/camera.h"

namespace lodestone {

// Pixels [x0, x1] x [y0, y1] of the picture, rows from the top, and a window depth in [0, 1] that nothing in the box is
// nearer than. x0 > x1 or y0 > y1: nothing of it is in the picture.
struct ScreenBox {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
  float nearest = 0;
};

// Contains every pixel that a triangle with its corners in `box` can touch, those corners transformed in float by any
// order of operations and snapped to 1/256 of a pixel. Empty for a box that is not entirely in front of the near plane.
[[nodiscard]] std::optional<ScreenBox> screen_box(const ViewProjection& view_projection, const Box3f& box,
                                                  ImageSize size);

class DepthPyramid {
 public:
  static constexpr int block_size = 8;  // pixels

  // A picture in which nothing hides anything.
  void reset(ImageSize size);

  // The finest level, to be filled and then built upon: no sample of a block is farther. Row by row.
  [[nodiscard]] std::span<float> blocks() { return levels_.front().farthest; }
  [[nodiscard]] int columns() const { return levels_.front().columns; }
  [[nodiscard]] int rows() const { return levels_.front().rows; }
  void build();

  // True if all pixels that the box covers are nearer than the box, also if it covers none.
  [[nodiscard]] bool hides(const ScreenBox& box) const;

 private:
  struct Level {
    int columns = 0, rows = 0;
    std::vector<float> farthest;
  };
  struct Range {  // of blocks, inclusive
    int x0, y0, x1, y1;
  };
  [[nodiscard]] bool nearer(std::size_t level, int x, int y, const Range& finest, float depth) const;

  std::vector<Level> levels_{1};
};

// The farthest depth of every block of a picture, for what has no blocks of its own. `depth`: a value a pixel.
void fill_blocks(std::span<const float> depth, ImageSize size, DepthPyramid& pyramid);

}  // namespace lodestone
