// Boxes around the parts of long triangles, so that the boxes of needles hardly overlap.
//
// The box of a needle across the axes is far larger than the needle and contains many others; the boxes of its halves
// are a quarter as large, and so on (the early split clipping of ernst2007, with cuts across the longest side in place
// of axis-aligned ones).
#pragma once

#include <array>
#include <vector>

#include "core/spatial/box_tree.h"

namespace lodestone {

// Adds items to those of a BoxTree, one for each of `triangles` in their order: where one box is much larger than the
// triangle and than a fair share of the whole, the item gets the box of a part and new items of the same number get the
// others. At most `most` items are added, the largest boxes divided first.
void divide_boxes(std::vector<BoxTree::Item>& items, const std::vector<std::array<Vec3d, 3>>& triangles,
                  std::size_t most);

}  // namespace lodestone
