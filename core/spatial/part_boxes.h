// Boxes around the parts of long triangles, so that the boxes of needles hardly overlap.
//
// The box of a needle across the axes is far larger than the needle and contains many others; the boxes of its halves
// are a quarter as large, and so on (the early split clipping of ernst2007, with cuts across the longest side in place
// of axis-aligned ones).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/spatial/box_tree.h"

namespace lodestone {

using CornersOf = std::function<std::array<Vec3d, 3>(std::uint32_t triangle)>;

// Adds items to those of a BoxTree, of which the first `count` are those of triangles: where one box is much larger
// than the triangle and than a fair share of the whole, the item gets the box of a part and new items of the same
// number get the others. At most `most` items are added, the largest boxes divided first.
void divide_boxes(std::vector<BoxTree::Item>& items, std::size_t count, const CornersOf& corners_of, std::size_t most);

}  // namespace lodestone
