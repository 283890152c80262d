// Occlusion culling in two passes (haar2015): cells that were hidden in the last frame wait until the others are drawn,
// and are drawn only where these do not hide them.
//
// The picture of the first pass is one of this frame: whatever it hides is hidden, however the camera has moved since
// the last one. That one decides the order alone, never what is seen.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/culling/depth_pyramid.h"
#include "render/frame/frame.h"

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
  [[nodiscard]] std::size_t size() const { return hidden_.size(); }

  // Was what covers the place of this cell hidden: the cell itself, the one above it, or all those below it? What was
  // out of view was not.
  [[nodiscard]] bool were_there(const Hierarchy& hierarchy, std::uint32_t cell) const;

 private:
  [[nodiscard]] bool was_hidden(std::uint32_t cell) const { return hidden_[cell] + 1 == frame_; }
  std::vector<std::uint32_t> hidden_;  // by cell: the frame that noted it last
  std::uint32_t frame_ = 2;            // nothing is noted of frame 1
};

// What backends keep from frame to frame. In a frame: begin(); draw the cells that do not wait; fill and build the
// pyramid; draw those of the others that it does not hide; if there were any, fill and build again; ask whether it
// hides what has been drawn, for the next frame. Models are counted as in Frame::models.
class OcclusionCulling {
 public:
  // The frame must stay until the next call.
  void begin(const Frame& frame);
  [[nodiscard]] bool waits(std::size_t model, std::uint32_t cell) const {
    return histories_[model].cells.were_there(*histories_[model].hierarchy, cell);
  }
  // What it hides is noted for the next frame.
  [[nodiscard]] bool hides(std::size_t model, std::uint32_t cell, int level);
  [[nodiscard]] DepthPyramid& pyramid() { return pyramid_; }

 private:
  struct History {
    const Hierarchy* hierarchy = nullptr;
    HiddenCells cells;
  };
  const Frame* frame_ = nullptr;
  std::vector<History> histories_;  // by place in Frame::models
  DepthPyramid pyramid_;
};

}  // namespace lodestone
