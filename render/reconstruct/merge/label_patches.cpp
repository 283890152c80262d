#include "render/reconstruct/merge/label_patches.h"

#include "core/base/disjoint_sets.h"

namespace lodestone {
namespace {

constexpr unsigned left_edge = cell_prs | cell_prq, right_edge = cell_psq | cell_rsq, upper_edge = cell_psq | cell_prq,
                   lower_edge = cell_prs | cell_rsq;

// The triangles of one cell share its diagonal, so that cells are what hangs together. Returns how many triangles each
// patch has.
std::vector<std::uint32_t> label_view(const MergeView& view, PixelArray<std::uint32_t>& label) {
  const auto width = static_cast<std::size_t>(view.map->view.width);
  const PixelArray<std::uint8_t>& cells = view.kept;
  label = cells.like<std::uint32_t>();
  DisjointSets runs;  // of cells in a row
  std::vector<std::uint32_t> size;
  cells.groups().for_pixels(0, cells.size(), [&](std::size_t i) {
    const unsigned cell = cells[i];
    if (cell == 0) return;
    const bool goes_on = i % width > 0 && (cell & left_edge) && (cells[i - 1] & right_edge);
    if (goes_on)
      label[i] = label[i - 1];
    else
      label[i] = runs.add(), size.push_back(0);
    size[label[i]] += static_cast<std::uint32_t>(__builtin_popcount(cell & cell_triangles));
    if (i >= width && (cell & upper_edge) && (cells[i - width] & lower_edge)) runs.unite(label[i], label[i - width]);
  });
  std::vector<std::uint32_t> number(runs.size()), triangles;
  for (std::uint32_t run = 0; run < number.size(); ++run) {
    const std::uint32_t root = runs.find(run);  // not after the run
    if (root == run) {
      number[run] = static_cast<std::uint32_t>(triangles.size());
      triangles.push_back(0);
    }
    number[run] = number[root];
    triangles[number[run]] += size[run];
  }
  cells.groups().for_pixels(0, cells.size(), [&](std::size_t i) {
    if (cells[i]) label[i] = number[label[i]];
  });
  return triangles;
}

}  // namespace

ViewPatches label_patches(std::span<const MergeView> views, Scheduler& scheduler) {
  ViewPatches patches;
  patches.of_cell.resize(views.size());
  std::vector<std::vector<std::uint32_t>> sizes(views.size());
  scheduler.for_chunks(views.size(), 1, [&](ChunkRange range) {
    sizes[range.index] = label_view(views[range.index], patches.of_cell[range.index]);
  });
  std::vector<std::uint32_t> first(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    first[v] = static_cast<std::uint32_t>(patches.triangles.size());
    patches.triangles.insert(patches.triangles.end(), sizes[v].begin(), sizes[v].end());
  }
  scheduler.for_chunks(views.size(), 1, [&](ChunkRange range) {
    PixelArray<std::uint32_t>& label = patches.of_cell[range.index];
    label.groups().for_pixels(0, label.size(), [&](std::size_t i) { label[i] += first[range.index]; });
  });
  return patches;
}

}  // namespace lodestone
