// Which cells share a set of buffers. Knows no OpenGL.
//
// A storage block holds at most what the driver says (128 MiB on llvmpipe, some 11 million positions). A larger
// hierarchy is cut into groups of cells that are consecutive in depth-first order. A vertex shader reads the parent's
// vertices too: a parent that lies in an earlier group gets a second copy, the group's *halo*. Depth-first order makes
// the halo small: the only parents outside are ancestors of the group's first cell, one per level at most.
//
// Rejected: the parent's position stored with every vertex (12 more bytes per vertex for every model, large or not),
// and groups by level (each needs a second copy of a large part of the coarser level).
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/hierarchy.h"

namespace lodestone {

struct CellGroup {
  std::vector<std::uint32_t> cells;  // drawn from this group; depth-first order
  std::vector<std::uint32_t> halo;   // parents of some of them that are drawn from another group
  std::uint64_t vertices = 0;        // of cells and halo
  std::uint64_t indices = 0;         // of cells: three a triangle
};

// Where the hierarchy's cells are found, by index in Hierarchy::cells.
struct CellPlace {
  std::uint32_t group = 0;
  std::uint32_t first_vertex = 0, parent_first_vertex = 0;  // in the group's vertices: the cells, then the halo
  std::uint32_t first_index = 0;                            // in the group's indices
};

struct CellGroups {
  std::vector<CellGroup> groups;
  std::vector<CellPlace> places;
};

// Greedy: a group is closed when the next cell would exceed `max_vertices`. Throws ResourceError when a single cell and
// its parent do. O(cells).
[[nodiscard]] CellGroups plan_groups(const Hierarchy& hierarchy, std::uint64_t max_vertices);

}  // namespace lodestone
