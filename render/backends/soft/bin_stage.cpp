#include "render/backends/soft/bin_stage.h"

#include <cassert>

#include "render/backends/soft/clip.h"
#include "render/backends/soft/edge_walk.h"

namespace lodestone::soft {
namespace {

SnappedPoint point(const WindowVertex& v) { return {v.x, v.y}; }

class Binner {
 public:
  Binner(const Frame& frame, const Viewport& viewport, const TileGrid& grid, std::span<const WindowVertex> vertices,
         std::vector<BinScratch::Entry>& entries, Batch& out)
      : frame_(frame), viewport_(viewport), grid_(grid), vertices_(vertices), entries_(entries), out_(out) {}

  void add_cell(const DrawnCell& drawn, std::uint32_t tag) {
    for (const Triangle& triangle : frame_.morph.hierarchy->cells[drawn.selected.cell].triangles) {
      const std::uint32_t a = drawn.first_vertex + triangle.v[0], b = drawn.first_vertex + triangle.v[1],
                          c = drawn.first_vertex + triangle.v[2];
      const std::uint32_t code_a = vertices_[a].outcode, code_b = vertices_[b].outcode, code_c = vertices_[c].outcode;
      if ((code_a & code_b & code_c & outside_any) != 0) continue;
      if (((code_a | code_b | code_c) & needs_clipping) == 0) {
        add({{a, b, c}, tag}, vertices_[a], vertices_[b], vertices_[c]);
      } else {
        add_clipped(drawn.selected, triangle, tag);
      }
    }
  }

 private:
  // An entry for every tile that the triangle's box touches, turned clockwise.
  void add(TriangleRef ref, const WindowVertex& a, const WindowVertex& b, const WindowVertex& c) {
    const PixelRect box = covered_box(point(a), point(b), point(c), {0, 0, grid_.size.width, grid_.size.height});
    if (empty(box)) return;
    const std::int64_t area = doubled_area(point(a), point(b), point(c));
    if (area == 0) return;
    if (area < 0) std::swap(ref.v[1], ref.v[2]);
    const int last_column = (box.x1 - 1) / tile_size, last_row = (box.y1 - 1) / tile_size;
    for (int row = box.y0 / tile_size; row <= last_row; ++row)
      for (int column = box.x0 / tile_size; column <= last_column; ++column)
        entries_.push_back({ref, static_cast<std::uint32_t>(row * grid_.columns + column)});
  }

  void add_clipped(const SelectedCell& selected, const Triangle& triangle, std::uint32_t tag) {
    const ClippedPolygon polygon =
        clip({clip_vertex(frame_, selected, triangle.v[0]), clip_vertex(frame_, selected, triangle.v[1]),
              clip_vertex(frame_, selected, triangle.v[2])},
             viewport_);
    const auto first = static_cast<std::uint32_t>(out_.clipped.size());
    for (const ClipVertex& corner : polygon.view()) {
      if (!(corner.w > 0)) return out_.clipped.resize(first);  // only a matrix that is no camera's
      out_.clipped.push_back(viewport_.snap(corner));
    }
    for (std::uint32_t k = 2; k < static_cast<std::uint32_t>(polygon.count); ++k)
      add({{clipped_bit | first, clipped_bit | (first + k - 1), clipped_bit | (first + k)}, tag}, out_.clipped[first],
          out_.clipped[first + k - 1], out_.clipped[first + k]);
  }

  const Frame& frame_;
  const Viewport& viewport_;
  const TileGrid& grid_;
  std::span<const WindowVertex> vertices_;
  std::vector<BinScratch::Entry>& entries_;
  Batch& out_;
};

// Counting sort by tile; stable, so that drawing order is kept within a tile.
void sort_by_tile(const std::vector<BinScratch::Entry>& entries, std::size_t tiles, Batch& out) {
  out.tile_begin.assign(tiles + 1, 0);
  for (const BinScratch::Entry& entry : entries) ++out.tile_begin[entry.tile];
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : out.tile_begin) sum += std::exchange(begin, sum);
  out.triangles.resize(entries.size());
  for (const BinScratch::Entry& entry : entries) out.triangles[out.tile_begin[entry.tile]++] = entry.triangle;
  // Each begin has moved on to its end, which is the next one's begin.
  for (std::size_t tile = tiles; tile > 0; --tile) out.tile_begin[tile] = out.tile_begin[tile - 1];
  out.tile_begin[0] = 0;
}

}  // namespace

void bin_batch(const Frame& frame, const Viewport& viewport, const TileGrid& grid, std::span<const DrawnCell> cells,
               std::span<const WindowVertex> vertices, std::uint32_t index, BinScratch& scratch, Batch& out) {
  static_assert(max_level < 16, "four bits of the tag hold the level");
  assert(index < (1u << 28));
  scratch.entries.clear();
  out.clipped.clear();
  Binner binner(frame, viewport, grid, vertices, scratch.entries, out);
  for (const DrawnCell& drawn : cells) binner.add_cell(drawn, index << 4 | drawn.selected.level);
  sort_by_tile(scratch.entries, grid.count(), out);
}

}  // namespace lodestone::soft
