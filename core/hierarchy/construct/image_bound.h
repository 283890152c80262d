// A bound of a cell's error from the images of the finest mesh's vertices alone, without any search.
//
// No point of a triangle of M_L is farther from the same point of the triangle's image than one of the corners is from
// its own image. The image is a triangle of M_l, or has collapsed to a point or a segment. If the segment is not an
// edge of the cell, a point of it is at most half its length from an end, and a point of the triangle is at most the
// longest side over the root of 3 from a corner.
#pragma once

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Bound for `cell`; the cells [first, end) of the finest level are those below it. All their vertices are followed
// upwards: the time is in proportion to these and to the levels.
[[nodiscard]] double image_bound(const Hierarchy& hierarchy, CellId cell, CellRank first, CellRank end);

}  // namespace lodestone
