// Occlusion culling in two passes (haar2015): cells that were hidden in the last frame wait until the others are drawn,
// and are drawn only if these do not hide them.
//
// The picture of the first pass is one of this frame: a cell that it hides is hidden, however the camera has moved
// since the last one. The last frame decides the order alone, never the picture.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/culling/depth_pyramid.h"
#include "render/frame/frame.h"

namespace lodestone {

// True if the pyramid hides all of a selected cell, for any lambda of its vertices.
[[nodiscard]] bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, CellId cell, int level,
                             const ViewProjection& view_projection, ImageSize size);

// Which cells of a hierarchy were hidden in the frame before.
class HiddenCells {
 public:
  // Forgets all. Cells of a hierarchy with so many of them.
  void reset(std::size_t cells);
  // Begins a new frame; cells noted since the last call belong to the frame before.
  void next_frame() { ++frame_; }
  void note(CellId cell) { hidden_[cell] = frame_; }
  [[nodiscard]] std::size_t size() const { return hidden_.size(); }

  // Was what covers the place of this cell hidden: the cell itself, the one above it, or all those below it? What was
  // out of view was not.
  [[nodiscard]] bool were_there(const Hierarchy& hierarchy, CellId cell) const;

 private:
  [[nodiscard]] bool was_hidden(CellId cell) const { return hidden_[cell] + 1 == frame_; }
  std::vector<std::uint32_t> hidden_;  // by cell: the frame that noted it last
  std::uint32_t frame_ = 2;            // nothing is noted of frame 1
};

// State that backends keep from frame to frame. In a frame: begin(); draw the cells that do not wait; fill and build
// the pyramid; draw those of the others that it does not hide; if there were any, fill and build again; query the cells
// that it hides, for the next frame. Models are counted as in Frame::models.
class OcclusionCulling {
 public:
  // The frame must exist until the next call.
  void begin(const Frame& frame);
  [[nodiscard]] bool waits(std::size_t model, CellId cell) const {
    return histories_[model].cells.were_there(*histories_[model].hierarchy, cell);
  }
  // Notes hidden cells for the next frame.
  [[nodiscard]] bool hides(std::size_t model, CellId cell, int level);
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
