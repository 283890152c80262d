#include "render/lod/occlusion.h"

namespace lodestone {

bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, std::uint32_t cell, int level,
               const ViewProjection& view_projection, ImageSize size) {
  const auto box = screen_box(view_projection, drawn_bounds(hierarchy, cell, level), size);
  return box && pyramid.hides(*box);
}

void HiddenCells::reset(std::size_t cells) {
  hidden_.assign(cells, 0);
  frame_ = 2;
}

bool HiddenCells::were_there(const Hierarchy& hierarchy, std::uint32_t cell) const {
  const Cell& c = hierarchy.cells[cell];
  if (was_hidden(cell) || (c.parent != no_cell && was_hidden(c.parent))) return true;
  for (std::uint32_t k = 0; k < c.child_count; ++k)
    if (!was_hidden(c.first_child + k)) return false;
  return c.child_count > 0;
}

}  // namespace lodestone
