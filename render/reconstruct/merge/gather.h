// Pixels to vertices: the steps between view meshes and a merged mesh.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/merge.h"

namespace lodestone {

// A few rows of one view: what a task works on.
struct RowBlock {
  std::size_t view = 0;
  int first = 0, last = 0;
};
inline constexpr int block_rows = 32;
[[nodiscard]] std::vector<RowBlock> row_blocks(std::span<const MergeView> views);
void for_blocks(std::span<const RowBlock> blocks, Scheduler& scheduler,
                const std::function<void(const RowBlock&, std::size_t)>& body);

// Which of a view's cells are meant: all that are connected, or those it keeps.
using CellChoice = const PixelArray<std::uint8_t>& (*)(const MergeView&);
[[nodiscard]] inline const PixelArray<std::uint8_t>& all_cells(const MergeView& v) { return v.mesh.cells; }
[[nodiscard]] inline const PixelArray<std::uint8_t>& kept_cells(const MergeView& v) { return v.kept; }

// Flags of each pixel of each view: it is a vertex on a border of its view's piece; that border is also the outline of
// the view; it is within a pixel of a border; within two.
enum PixelFlagBits : std::uint8_t { beside_border = 1, on_border = 2, on_rim = 4, near_border = 8 };
using PixelFlags = std::vector<PixelArray<std::uint8_t>>;
[[nodiscard]] PixelFlags find_borders(std::span<const MergeView> views, Scheduler& scheduler);

// Vertices of the triangles of the cells, in the order of views and pixels, and the triangles. With flags, the surface
// near a border is separated: its vertices come after the others, those near it just before them, triangles with a
// vertex near a border in a list of their own.
struct Gathered {
  MergedMesh mesh;
  std::size_t far = 0, frozen = 0;  // vertices that are not near a border; near, but not beside
  std::vector<Triangle> beside;
};
[[nodiscard]] Gathered gather(std::span<const MergeView> views, CellChoice cells, const PixelFlags& flags,
                              Scheduler& scheduler);

}  // namespace lodestone
