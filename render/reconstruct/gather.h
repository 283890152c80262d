// Pixels to vertices: the steps between view meshes and a merged mesh.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "parallel/scheduler.h"
#include "render/reconstruct/merge.h"
#include "render/reconstruct/seam_mesh.h"

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
using CellChoice = const std::vector<std::uint8_t>& (*)(const MergeView&);
[[nodiscard]] inline const std::vector<std::uint8_t>& all_cells(const MergeView& v) { return v.mesh.cells; }
[[nodiscard]] inline const std::vector<std::uint8_t>& kept_cells(const MergeView& v) { return v.kept; }

// Of each pixel of each view: whether it is a vertex on a border of what its view keeps, and beside one.
using PixelFlags = std::vector<std::vector<std::uint8_t>>;
[[nodiscard]] PixelFlags find_borders(std::span<const MergeView> views, Scheduler& scheduler);

// Vertices of the triangles of the cells, in the order of views and pixels, and the triangles. With flags, what is
// within two pixels of a border is put apart: vertices behind the others, triangles (with any of them) in a list of
// their own.
struct Gathered {
  MergedMesh mesh;
  std::size_t settled = 0;       // vertices that are not beside a border
  std::vector<Triangle> beside;  // triangles that are
};
[[nodiscard]] Gathered gather(std::span<const MergeView> views, CellChoice cells, const PixelFlags& flags,
                              Scheduler& scheduler);

// What was put apart, ready to be changed. `parts`: of the model's triangles, or empty.
struct CutOut {
  SeamMesh seam;
  std::vector<std::uint32_t> vertex;  // of the merged mesh, for each of the seam mesh
};
[[nodiscard]] CutOut cut_out_seams(std::span<const MergeView> views, std::span<const std::uint32_t> parts,
                                   const PixelFlags& flags, const Gathered& gathered, Scheduler& scheduler);
// Puts it back: triangles behind those that were settled, vertices that are still used behind the settled ones.
void put_back(const CutOut& part, Gathered& gathered);

}  // namespace lodestone
