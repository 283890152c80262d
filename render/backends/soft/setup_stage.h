// Stage 2 as a whole: the triangles of a cell, clipped where they must be, as fragments and records in the lists of the
// tiles that they touch.
#pragma once

#include "render/backends/soft/bins.h"
#include "render/backends/soft/kernels.h"
#include "render/backends/soft/raster_types.h"
#include "render/backends/soft/viewport.h"

namespace lodestone::soft {

// The projection and picture that all cells of a pass share.
struct SetupContext {
  ViewProjection ModelFrame::*projection = &ModelFrame::view_projection;
  const Viewport* viewport = nullptr;
  const TileGrid* grid = nullptr;
};

// The fragments and triangles that one worker has found, by tile.
struct TileBins {
  Bins<Fragment> fragments;
  Bins<TriangleRecord> triangles;
};

// Triangles of a cell that are drawn, and all of its vertices, transformed.
struct CellInWindow {
  std::span<const Triangle> triangles;
  const WindowVertex* vertices = nullptr;
  TriangleNumber first_triangle = 0;  // number of the first; those of the others follow
};

// Bins triangles of a cell.
template <int Samples>
void setup_cell(const SetupContext& context, const SampleKernels<Samples>& kernels, const DrawnCell& cell,
                const CellInWindow& window, SetupLists& lists, TileBins& bins);

// Twice the signed area; positive when a, b, c turn clockwise in the picture.
[[nodiscard]] constexpr std::int64_t doubled_area(SnappedPoint a, SnappedPoint b, SnappedPoint c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

// Puts a triangle, of either orientation, into the lists of all tiles that it may cover a sample of.
template <int Samples>
void bin_triangle(TriangleRecord record, const TileGrid& grid, Bins<TriangleRecord>& bins);

}  // namespace lodestone::soft
