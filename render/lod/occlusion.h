// Occlusion culling in two passes (haar2015): cells that were hidden in the last frame wait until the others are drawn,
// and are drawn only where these do not hide them.
//
// The picture of the first pass is one of this frame: whatever it hides is hidden, however the camera has moved since
// the last one. That one decides the order alone, never what is seen.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/hierarchy.h"
#include "render/lod/depth_pyramid.h"
#include "render/lod/selection.h"

namespace lodestone {

// Does the pyramid hide all of a selected cell, whatever its vertices' lambda?
[[nodiscard]] bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, std::uint32_t cell, int level,
                             const ViewProjection& view_projection, ImageSize size);

// Which cells of a hierarchy were hidden in the frame before.
class HiddenCells {
 public:
  // Forgets all. Cells of a hierarchy with so many of them.
  void reset(std::size_t cells);
  // What is noted from now on is of a new frame; what was noted since the last call is of the frame before.
  void next_frame() { ++frame_; }
  void note(std::uint32_t cell) { hidden_[cell] = frame_; }

  // Was what covers the place of this cell hidden: the cell itself, the one above it, or all those below it? What was
  // out of view was not.
  [[nodiscard]] bool were_there(const Hierarchy& hierarchy, std::uint32_t cell) const;

 private:
  [[nodiscard]] bool was_hidden(std::uint32_t cell) const { return hidden_[cell] + 1 == frame_; }
  std::vector<std::uint32_t> hidden_;  // by cell: the frame that noted it last
  std::uint32_t frame_ = 2;            // nothing is noted of frame 1
};

}  // namespace lodestone
