// Occlusion culling in two passes (haar2015): cells that were hidden in the last frame wait until the others are drawn,
// and are drawn only if these do not hide them. Runs of a cell's triangles (render/culling/runs.h) wait likewise.
//
// The picture of the first pass is one of this frame: what it hides is hidden, however the camera has moved since the
// last one. The last frame decides the order alone, never the picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/culling/depth_pyramid.h"
#include "render/frame/frame.h"

namespace lodestone {

// True if the pyramid hides all of a selected cell, for any lambda of its vertices.
[[nodiscard]] bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, CellId cell, int level,
                             const ViewProjection& view_projection, ImageSize size);

// Which cells of a hierarchy, and which runs of them, were hidden in the frame before.
class HiddenCells {
 public:
  // Forgets all. Cells of a hierarchy with so many of them.
  void reset(std::size_t cells);
  // Begins a new frame; what was noted since the last call belongs to the frame before.
  void next_frame() { ++frame_; }
  void note(CellId cell) { hidden_[cell] = frame_; }
  void note_run(CellId cell, std::size_t run);
  [[nodiscard]] std::size_t size() const { return hidden_.size(); }

  // Was what covers the place of this cell hidden: the cell itself, the one above it, or all those below it? What was
  // out of view was not.
  [[nodiscard]] bool were_there(const Hierarchy& hierarchy, CellId cell) const;
  [[nodiscard]] bool was_run_hidden(CellId cell, std::size_t run) const {
    return run < runs_[cell].size() && runs_[cell][run] + 1 == frame_;
  }

 private:
  [[nodiscard]] bool was_hidden(CellId cell) const { return hidden_[cell] + 1 == frame_; }
  std::vector<std::uint32_t> hidden_;             // by cell: the frame that noted it last
  std::vector<std::vector<std::uint32_t>> runs_;  // by cell and run: the same, up to the last that was ever noted
  std::uint32_t frame_ = 2;                       // nothing is noted of frame 1
};

// Triangles of a visible cell that are drawn in one pass.
struct VisiblePart {
  std::uint32_t model = 0;   // as counted in Frame::models
  std::uint32_t number = 0;  // of the cell, as the backend counts them
  CellId cell{};
  std::uint8_t level = 0;
  std::span<const TriangleRange> ranges{};  // as SelectedCell has them
  bool is_rest = false;                     // other triangles of the cell have been drawn in the first pass
};

// Parts, and the ranges of those that were divided.
class VisibleParts {
 public:
  void clear();
  void add(const VisiblePart& part) { add(part, {}); }
  // With these ranges, if there are any.
  void add(const VisiblePart& part, std::span<const TriangleRange> ranges);
  // Makes the spans of the parts valid, which adding has moved.
  void finish();
  [[nodiscard]] std::span<const VisiblePart> parts() const { return parts_; }

 private:
  std::vector<VisiblePart> parts_;
  std::vector<std::size_t> ends_;  // by part: end of its ranges in ranges_
  std::vector<TriangleRange> ranges_;
};

// State that backends keep from frame to frame. Runs wait as long as few of them come into sight: drawing again where
// they do costs more than the others save. In a frame: draw first(); fill the pyramid; draw second(); if that was
// anything, fill it again; finish().
class OcclusionCulling {
 public:
  // Begins a frame, which must exist until its end. Returns what is drawn first of its visible cells, whose ranges must
  // exist until then, too.
  [[nodiscard]] std::span<const VisiblePart> first(const Frame& frame, std::span<const VisiblePart> visible);
  // Returns what waited and is not hidden.
  [[nodiscard]] std::span<const VisiblePart> second();
  // Notes what the finished picture hides, for the next frame.
  void finish();
  // Its finest level is to be filled.
  [[nodiscard]] DepthPyramid& pyramid() { return pyramid_; }

  [[nodiscard]] bool has_second() const { return !second_.parts().empty(); }
  // In this frame: cells without a drawn triangle, triangles left out, and cells drawn in both passes.
  [[nodiscard]] std::size_t hidden_cells() const { return hidden_cells_; }
  [[nodiscard]] std::uint64_t hidden_triangles() const { return hidden_triangles_; }
  [[nodiscard]] std::size_t divided_cells() const { return divided_cells_; }

 private:
  struct History {
    const Hierarchy* hierarchy = nullptr;
    HiddenCells cells;
  };
  [[nodiscard]] const Cell& cell_of(const VisiblePart& part) const {
    return histories_[part.model].hierarchy->cells[part.cell];
  }
  template <class Test>
  void divide(const VisiblePart& part, const Test& goes_to_rest);
  bool hide_cell(const VisiblePart& part);
  void hide_runs(const VisiblePart& part, bool counts_revealed);

  const Frame* frame_ = nullptr;
  std::vector<History> histories_;  // by place in Frame::models
  DepthPyramid pyramid_;
  VisibleParts first_, waiting_, second_;
  std::vector<TriangleRange> kept_, rest_;   // of the part that was divided last
  std::size_t revealed_ = 0, remained_ = 0;  // runs that were hidden in the frame before, and are not, or are, in this
  std::size_t hidden_cells_ = 0, divided_cells_ = 0;
  std::uint64_t hidden_triangles_ = 0;
};

}  // namespace lodestone
