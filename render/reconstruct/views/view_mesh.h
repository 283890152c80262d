// The mesh of one view: neighbouring pixels of a position map connected into triangles, after Deng et al. (see
// docs/decisions/0020). A kernel: rows of one map, no threads.
//
// Between four pixels lies a *cell*:
//
//     p --- q      its triangles are named by their corners, counter-clockwise as seen:
//     |     |          p r s and p s q with one diagonal, p r q and r s q with the other;
//     r --- s          where a corner is missing, the one without it
//
// Two pixels are connected unless the depth between them jumps: by more than the slopes of the surface at the two
// explain, and `slack` besides. Of two possible diagonals the one that bridges less depth is taken, which is the
// shorter one in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "render/position_map/position_map.h"

namespace lodestone {

struct ConnectConfig {
  float max_slope = 8;   // depth over width that a surface may have between two pixels, and no steeper is believed; > 0
  float slack = 1;       // in pixel spacings: a jump of this depth is bridged anyway; >= 0
  bool oriented = true;  // the mesh's triangles agree on the outside: never connect an outside with an inside
  // Number of the part of each triangle of the mesh; parts are never connected with each other; empty: one part.
  std::span<const std::uint32_t> parts{};
  // Neighbours with which a finer map has found each pixel connected (LinkBits, condense_map.h); null: not known.
  const PixelArray<std::uint8_t>* links = nullptr;
};

// From a pixel to the one at its right, the one below, the one right of that; and from its right one to the one below.
enum LinkBits : std::uint8_t { link_right = 1, link_down = 2, link_diagonal = 4, link_across = 8, link_all = 15 };

// True if two pixels of a map are connected, `b` being (dx, dy) pixels away from `a`, at most one in each direction.
// This is the definition, pixel by pixel; connect_rows keeps its results for a whole row.
[[nodiscard]] bool are_connected(const PositionMap& map, const ConnectConfig& config, std::size_t a, std::size_t b,
                                 int dx, int dy);

enum CellBits : std::uint8_t {
  cell_prs = 1,
  cell_psq = 2,
  cell_prq = 4,
  cell_rsq = 8,
  cell_triangles = 15,
  cell_turned = 16
};

struct ViewMesh {
  PixelArray<std::uint8_t> cells;  // of the cell right of and below each pixel: CellBits
};

// Cells of the rows [first, last) of the map, into view_mesh.cells (of its groups of pixels). Disjoint rows may be
// connected at once.
void connect_rows(const PositionMap& map, const ConnectConfig& config, int first, int last, ViewMesh& mesh);

// All of it.
[[nodiscard]] ViewMesh connect(const PositionMap& map, const ConnectConfig& config);

// Calls visit(a, b, c) with the pixels of the triangles of a cell, reversed where the view sees the inside.
template <class Visit>
inline void for_triangles_of_cell(std::uint8_t cell, std::uint32_t pixel, std::uint32_t width, const Visit& visit) {
  const std::uint32_t p = pixel, q = pixel + 1, r = pixel + width, s = r + 1;
  const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    cell& cell_turned ? visit(a, c, b) : visit(a, b, c);
  };
  if (cell & cell_prs) emit(p, r, s);
  if (cell & cell_psq) emit(p, s, q);
  if (cell & cell_prq) emit(p, r, q);
  if (cell & cell_rsq) emit(r, s, q);
}

// Appends the triangles of the rows, corners as pixel numbers.
void list_triangles(const ViewMesh& mesh, int width, int first, int last, std::vector<Triangle>& triangles);

// For maps of other renderers: computes normals from the positions of neighbours, on the side of the viewer; of the
// one-sided differences those that jump less.
void estimate_normals(PositionMap& map);

// Grows the map by what lies between its outermost pixels and the silhouette, half a pixel on the average: an empty
// pixel beside one that sees the surface gets the point half way towards it, in the tangent plane, so that parts of one
// or two pixels' width become strips and not nothing. Returns the pixels that were filled. `max_slope`: as above;
// steeper surfaces are extended by this slope.
std::vector<std::uint32_t> extend_to_silhouette(PositionMap& map, float max_slope);

}  // namespace lodestone
