#include "render/lod/occlusion.h"

namespace lodestone {

Box3f drawn_bounds(const Hierarchy& hierarchy, const SelectedCell& cell) {
  // A blend of two places may leave the box of both by a rounding.
  const float margin = displacement_bound(hierarchy.sigma0, cell.level) + 1e-6f;
  Box3f box = hierarchy.cells[cell.cell].bounds;
  box.lo = {box.lo.x - margin, box.lo.y - margin, box.lo.z - margin};
  box.hi = {box.hi.x + margin, box.hi.y + margin, box.hi.z + margin};
  return box;
}

bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, const SelectedCell& cell,
               const ViewProjection& view_projection, ImageSize size) {
  const auto box = screen_box(view_projection, drawn_bounds(hierarchy, cell), size);
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
