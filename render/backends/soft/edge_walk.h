// Which pixels a triangle covers: edge functions in exact integer arithmetic (Pineda 1988) with the top-left rule.
//
// A pixel is covered when its centre lies inside the triangle, or on an edge that is a top or a left one. An edge that
// two triangles share is top-left for exactly one of them: along it no pixel is drawn twice and none is missed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "render/backends/soft/raster_types.h"

namespace lodestone::soft {

struct SnappedPoint {
  std::int32_t x = 0, y = 0;  // subpixels
};

// Twice the signed area; positive when a, b, c turn clockwise in the picture.
[[nodiscard]] constexpr std::int64_t doubled_area(SnappedPoint a, SnappedPoint b, SnappedPoint c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

// Pixels whose centres lie in the closed bounding box, inside `clip`.
[[nodiscard]] constexpr PixelRect covered_box(SnappedPoint a, SnappedPoint b, SnappedPoint c, PixelRect clip) {
  constexpr int half = subpixels / 2;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  // The shifts round towards minus infinity, for negative coordinates too.
  return {std::max(clip.x0, (left + half - 1) >> subpixel_bits), std::max(clip.y0, (top + half - 1) >> subpixel_bits),
          std::min(clip.x1, ((right - half) >> subpixel_bits) + 1),
          std::min(clip.y1, ((bottom - half) >> subpixel_bits) + 1)};
}

[[nodiscard]] constexpr bool empty(PixelRect r) { return r.x0 >= r.x1 || r.y0 >= r.y1; }

namespace detail {

// One edge from a to b: value(p) > 0 to its right hand in the picture, >= 0 where the edge itself belongs to the
// triangle.
template <class Int>
struct Edge {
  Int step_x, step_y;  // change per pixel
  Int bias;            // 0 for top and left edges, -1 for others: makes "> 0" a ">= 0"
  Int row;             // biased value at the first pixel of the row

  Edge(SnappedPoint a, SnappedPoint b, int x, int y) {
    const Int dx = b.x - a.x, dy = b.y - a.y;
    const bool top_left = dy < 0 || (dy == 0 && dx > 0);
    constexpr Int half = subpixels / 2;
    step_x = -dy * subpixels;
    step_y = dx * subpixels;
    bias = top_left ? 0 : -1;
    row = dx * (Int{y} * subpixels + half - a.y) - dy * (Int{x} * subpixels + half - a.x) + bias;
  }
};

template <class Int, class Visit>
void walk(SnappedPoint a, SnappedPoint b, SnappedPoint c, PixelRect box, Visit&& visit) {
  Edge<Int> ab(a, b, box.x0, box.y0), bc(b, c, box.x0, box.y0), ca(c, a, box.x0, box.y0);
  for (int y = box.y0; y < box.y1; ++y) {
    Int e_ab = ab.row, e_bc = bc.row, e_ca = ca.row;
    bool entered = false;
    for (int x = box.x0; x < box.x1; ++x) {
      if ((e_ab | e_bc | e_ca) >= 0) {
        // The share of a corner is the edge function of the opposite edge.
        visit(x, y, e_ca - ca.bias, e_ab - ab.bias);
        entered = true;
      } else if (entered) {
        break;  // convex: what was left is not entered again
      }
      e_ab += ab.step_x, e_bc += bc.step_x, e_ca += ca.step_x;
    }
    ab.row += ab.step_y, bc.row += bc.step_y, ca.row += ca.step_y;
  }
}

}  // namespace detail

// Calls visit(x, y, share_b, share_c) for the covered pixels of `box`, row by row; the shares over the doubled area are
// the barycentric coordinates of b and c. The corners must turn clockwise (positive doubled area), and `box` must be
// covered_box() of the triangle.
template <class Visit>
void for_each_covered(SnappedPoint a, SnappedPoint b, SnappedPoint c, PixelRect box, Visit&& visit) {
  // Inside a bounding box of 2^14 subpixels edge functions and their steps stay below 2^30.
  constexpr std::int32_t small = 1 << 14;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  if (right - left <= small && bottom - top <= small) {
    detail::walk<std::int32_t>(a, b, c, box, std::forward<Visit>(visit));
  } else {
    detail::walk<std::int64_t>(a, b, c, box, std::forward<Visit>(visit));
  }
}

}  // namespace lodestone::soft
