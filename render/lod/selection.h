// Which cells are drawn from a viewpoint, coarse to fine, and which of them the camera can see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/projection.h"
#include "render/lod/radii.h"

namespace lodestone {

class NormalCones;  // render/lod/normal_cones.h

// B(C) grown by as much as morphing vertices of its level may leave it.
[[nodiscard]] Box3f drawn_bounds(const Hierarchy& hierarchy, CellId cell, int level);

struct TriangleRange {
  std::uint32_t begin = 0, end = 0;  // of a cell, in its order
};

struct SelectedCell {
  CellId cell;
  std::uint8_t level = 0;
  bool visible = true;                      // false: selected, but culled
  bool morphing = true;                     // false: lambda = 1 on the whole box, the static path may draw it
  std::span<const TriangleRange> ranges{};  // ascending: those that may be seen; empty: all (render/culling/runs.h)
};

// Ranges of the triangles of a selected cell that are drawn.
template <class Visit>
void for_each_range(const Cell& cell, std::span<const TriangleRange> ranges, const Visit& visit) {
  const TriangleRange all{0, static_cast<std::uint32_t>(cell.triangles.size())};
  for (const TriangleRange range : ranges.empty() ? std::span(&all, 1) : ranges) visit(range);
}
[[nodiscard]] std::size_t drawn_triangles(const Cell& cell, std::span<const TriangleRange> ranges);

struct Selection {
  std::vector<SelectedCell> cells;  // in traversal order (Morton within a parent): a partition of M_L
  std::uint32_t visited = 0;        // cells that the traversal looked at
};

// A cell of level l is drawn iff its ancestors are not, and l = L or d(v_p, B(C)) >= r_l, or R_C. Culling happens after
// that: with B(C) grown by sigma0 h_l / 2, since morphed vertices leave B. A null frustum culls nothing; with one,
// whole subtrees outside it are left out when `keep_culled` is false, and marked visible = false otherwise. With cones,
// cells that turn their backs to the viewpoint are culled, too; BackFaces tells if backs can be seen.
struct SelectionConfig {
  const Frustum* frustum = nullptr;
  bool keep_culled = true;  // list culled cells as the exact partition needs them (metrics); false: leave them out
  DetailLimits limits{};    // selects by d' instead of d; the morph must have the same ones
  const NormalCones* cones = nullptr;
};

// `out` is reused between frames. The viewpoint is in normalised model space.
void select_cells(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, const SelectionConfig& config,
                  Selection& out);

}  // namespace lodestone
