#include "render/culling/occlusion.h"

#include <utility>

namespace lodestone {

bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, CellId cell, int level,
               const ViewProjection& view_projection, ImageSize size) {
  const auto box = screen_box(view_projection, drawn_bounds(hierarchy, cell, level), size);
  return box && pyramid.hides(*box);
}

void HiddenCells::reset(std::size_t cells) {
  hidden_.assign(cells, 0);
  frame_ = 2;
}

bool HiddenCells::were_there(const Hierarchy& hierarchy, CellId cell) const {
  const Cell& c = hierarchy.cells[cell];
  if (was_hidden(cell) || (c.parent != no_cell && was_hidden(c.parent))) return true;
  for (CellId k = c.first_child; k < c.end_child(); ++k)
    if (!was_hidden(k)) return false;
  return c.child_count > 0;
}

void OcclusionCulling::begin(const Frame& frame) {
  frame_ = &frame;
  pyramid_.reset(frame.size);
  histories_.resize(frame.models.size());
  for (std::size_t m = 0; m < frame.models.size(); ++m) {
    History& history = histories_[m];
    const Hierarchy* const hierarchy = frame.models[m].morph.hierarchy;
    if (std::exchange(history.hierarchy, hierarchy) != hierarchy || history.cells.size() != hierarchy->cells.size())
      history.cells.reset(hierarchy->cells.size());
    history.cells.next_frame();
  }
}

bool OcclusionCulling::hides(std::size_t model, CellId cell, int level) {
  History& history = histories_[model];
  if (!is_hidden(pyramid_, *history.hierarchy, cell, level, frame_->models[model].view_projection, frame_->size))
    return false;
  history.cells.note(cell);
  return true;
}

}  // namespace lodestone
