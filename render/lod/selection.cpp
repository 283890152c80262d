#include "render/lod/selection.h"

#include "render/lod/limits.h"
#include "render/lod/normal_cones.h"

namespace lodestone {

std::size_t drawn_triangles(const Cell& cell, std::span<const TriangleRange> ranges) {
  if (ranges.empty()) return cell.triangles.size();
  std::size_t count = 0;
  for (const TriangleRange range : ranges) count += range.end - range.begin;
  return count;
}

Box3f drawn_bounds(const Hierarchy& hierarchy, CellId cell, int level) {
  // A blend of two places may leave the box of both by a rounding.
  const float margin = hierarchy.displacement_bound(level) + 1e-6f;
  Box3f box = hierarchy.cells[cell].bounds;
  box.lo = {box.lo.x - margin, box.lo.y - margin, box.lo.z - margin};
  box.hi = {box.hi.x + margin, box.hi.y + margin, box.hi.z + margin};
  return box;
}

namespace {

// True if lambda = 1 on the whole box: its farthest corner lies at most at the beginning of the band. By adaptive radii
// if it is so for the cell's own vertices, for then it is for those that it shares.
bool is_static(const Hierarchy& hierarchy, const Radii& radii, CellId id, std::size_t level, Vec3f viewpoint,
               DetailLimits limits) {
  const Box3f& box = hierarchy.cells[id].bounds;
  if (radii.by_cell.empty() || level == 0)
    return limited_farthest_distance(radii.metric, viewpoint, box, limits) < radii.band_begin[level];
  const float stale = radii.delta * hierarchy.cell_size(static_cast<int>(level));
  return limited_distance(radii.metric, viewpoint, box, limits) <= radii.by_cell[id] + stale;
}

class Traversal {
 public:
  Traversal(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, const SelectionConfig& config,
            Selection& out)
      : hierarchy_(hierarchy), radii_(radii), viewpoint_(viewpoint), config_(config), out_(out) {}

  void visit(CellId id, std::size_t level, bool visible) {
    const Cell& cell = hierarchy_.cells[id];
    ++out_.visited;
    // Morphed vertices leave B by at most the displacement bound. B of an ancestor contains B of all below it and its
    // bound is no smaller, so that a cell outside here is outside with its whole subtree.
    if (visible && config_.frustum)
      visible = !is_outside(*config_.frustum, cell.bounds, hierarchy_.displacement_bound(static_cast<int>(level)));
    if (!visible && !config_.keep_culled) return;
    const bool drawn = static_cast<int>(level) == hierarchy_.finest() ||
                       limited_distance(radii_.metric, viewpoint_, cell.bounds, config_.limits) >= radii_.of(id, level);
    const bool morphing = drawn && !is_static(hierarchy_, radii_, id, level, viewpoint_, config_.limits);
    if (visible && config_.cones) {
      const NormalCones& cones = *config_.cones;
      visible = !turns_away(!drawn ? cones.subtree(id) : morphing ? cones.morphing(id) : cones.still(id), id, level);
    }
    if (!visible && !config_.keep_culled) return;
    if (drawn) {
      out_.cells.push_back(
          {.cell = id, .level = static_cast<std::uint8_t>(level), .visible = visible, .morphing = morphing});
      return;
    }
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) visit(k, level + 1, visible);
  }

 private:
  [[nodiscard]] bool turns_away(const NormalCone& cone, CellId id, std::size_t level) const {
    return cone.sine < 1 && turns_its_back(cone, viewpoint_, drawn_bounds(hierarchy_, id, static_cast<int>(level)));
  }

  const Hierarchy& hierarchy_;
  const Radii& radii_;
  Vec3f viewpoint_;
  const SelectionConfig& config_;
  Selection& out_;
};

}  // namespace

void select_cells(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, const SelectionConfig& config,
                  Selection& out) {
  out.cells.clear();
  out.visited = 0;
  if (!hierarchy.cells.empty()) Traversal(hierarchy, radii, viewpoint, config, out).visit(CellId(0), 0, true);
}

}  // namespace lodestone
