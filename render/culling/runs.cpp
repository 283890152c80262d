#include "render/culling/runs.h"

#include <algorithm>
#include <cmath>

#include "render/culling/depth_pyramid.h"

namespace lodestone {
namespace {

bool is_inside(const Frustum& frustum, const Box3f& box) {
  return std::ranges::all_of(frustum, [&](const Plane& plane) { return side_of(plane, box) > 0; });
}

bool misses(const ViewProjection& view_projection, const Box3f& box, ImageSize size) {
  const std::optional<ScreenBox> place = screen_box(view_projection, box, size);
  return place && (place->x0 > place->x1 || place->y0 > place->y1);
}

// lambda w + (1 - lambda) P(w) in floats: four roundings, each of half a unit in the last place of no more than the
// larger of the two, and what they make of one another.
Box3f with_rounding(const Box3f& box) {
  const auto grown = [](float lo, float hi) { return 0x1p-21f * std::max(std::abs(lo), std::abs(hi)); };
  const Vec3f margin{grown(box.lo.x, box.hi.x), grown(box.lo.y, box.hi.y), grown(box.lo.z, box.hi.z)};
  return {box.lo - margin, box.hi + margin};
}

}  // namespace

void CullingRuns::cull(const Hierarchy& hierarchy, const ViewProjection& view_projection, ImageSize size,
                       Selection& selection, std::vector<TriangleRange>& ranges) {
  const Frustum frustum = frustum_of(view_projection);
  struct Part {
    SelectedCell* cell;
    std::size_t first, count;
  };
  std::vector<Part> parts;
  ranges.clear();
  for (SelectedCell& selected : selection.cells) {
    selected.ranges = {};
    if (!selected.visible || is_inside(frustum, drawn_bounds(hierarchy, selected.cell, selected.level))) continue;
    const auto triangles = static_cast<std::uint32_t>(hierarchy.cells[selected.cell].triangles.size());
    const float margin = hierarchy.displacement_bound(selected.level);
    const std::size_t first = ranges.size();
    std::uint32_t begin = 0, kept = 0;
    for (const Box3f& box : boxes(hierarchy, selected.cell)) {
      const std::uint32_t end = std::min(begin + length, triangles);
      if (!is_outside(frustum, box, margin) && !misses(view_projection, box, size)) {
        kept += end - begin;
        if (ranges.size() > first && ranges.back().end == begin)
          ranges.back().end = end;
        else
          ranges.push_back({begin, end});
      }
      begin = end;
    }
    if (kept == triangles) {
      ranges.resize(first);
      continue;
    }
    if (kept == 0) ranges.push_back({});
    parts.push_back({&selected, first, ranges.size() - first});
  }
  for (const Part& part : parts) part.cell->ranges = std::span(ranges).subspan(part.first, part.count);
}

std::span<const Box3f> CullingRuns::boxes(const Hierarchy& hierarchy, CellId id) {
  if (boxes_.size() < hierarchy.cells.size()) boxes_.resize(hierarchy.cells.size());
  std::vector<Box3f>& runs = boxes_[id];
  const Cell& cell = hierarchy.cells[id];
  if (!runs.empty() || cell.triangles.empty()) return runs;
  runs.resize((cell.triangles.size() + length - 1) / length);
  const std::span<const Vec3f> coarser =
      cell.parent == no_cell ? std::span<const Vec3f>() : hierarchy.cells[cell.parent].positions;
  std::size_t t = 0;
  for (const Triangle& triangle : cell.triangles) {
    Box3f& box = runs[t++ / length];
    for (const std::uint32_t v : triangle.v) {
      box.extend(cell.positions[v]);
      if (!coarser.empty()) box.extend(coarser[cell.parents[v]]);
    }
  }
  for (Box3f& box : runs) box = with_rounding(box);
  return runs;
}

void CullingRuns::forget(const Hierarchy& hierarchy, CellId parent) {
  const Cell& cell = hierarchy.cells[parent];
  for (CellId child = cell.first_child; child < cell.end_child() && child < boxes_.size(); ++child)
    std::vector<Box3f>().swap(boxes_[child]);
}

}  // namespace lodestone
