// Pops: how far the drawn vertices jump from one frame to the next, against what the morph promises.
//
// Within a level, a vertex moves by at most |w - P(w)| times the change of lambda:
//   |change of n| <= (sigma0 h_l / 2) Lip(b_l) |change of v_p|,   Lip(b_l) = Lip(s) / (c_l - a_l).
// Between two frames that draw the vertex at levels k <= m the largest of these over l = k..m bounds its jump, whatever
// levels it was drawn at in between: on the straight way from one viewpoint to the other, hold its level within [k, m];
// as the exchanges of levels are invisible (admissible radii), the path so defined is continuous, has the same ends,
// and moves by formulas of the levels k..m alone. Level 0 never moves.
//
// The radii may differ between the frames, too (a field of view that changes asks for others). Interpolate them
// linearly on the way: what makes radii admissible is linear in them, so they remain so. The share t = (d - a_l) / (c_l
// - a_l) of the band then changes by at most (|change of v_p| + max(|change of a_l|, |change of c_l|)) / smallest
// width: the shift of the band counts as way of the viewpoint, and the smaller of the two widths is the one that
// divides. So does what detail limits sank or rose by (render/lod/limits.h): with a share `limit_rate` of their excess
// in a frame, d' changes by at most -2 ln(1 - limit_rate) of itself.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

class Screen;  // experiments/metrics/drawn/screen.h

// One vertex between two frames.
struct VertexJump {
  double jump = 0;   // Euclidean, normalised units
  double bound = 0;  // of the jump, rounding of the distances included
  double way = 0;    // to the parent, at most, and through the levels between the two: a jump is never longer
  double ratio = 0;  // max(0, jump - jump_rounding) / bound; 0 / 0 = 0
  Vec3f from, to;    // the drawn positions
  CellId cell;       // the finer of the two drawn cells, and the vertex in it
  VertexId vertex;
  std::uint8_t level_from = 0, level_to = 0;  // of the cells that draw it in the two frames
};

struct PopReport {
  double max_jump = 0;            // largest jump, normalised units
  double jump_over_bound = 0;     // largest ratio; above 1: a pop
  VertexJump largest;             // the vertex of max_jump
  VertexJump worst;               // the vertex of jump_over_bound
  std::uint64_t above_bound = 0;  // vertices with a ratio above 1, those of several cells counted in each
  double step = 0;                // Euclidean length of the step of the viewpoint
  // By JumpTracker: the largest jump that detail limits make alone, from those of the earlier frame to those of the
  // later one, camera and radii of which both have. Within the bound a picture may still move, even for ever.
  double max_limit_jump = 0;
  std::uint64_t vertices = 0;  // looked at, those of several cells counted in each
  // With JumpConfig::percentiles: the smallest jump that 99 % of the vertices do not exceed, those at rest included.
  double p99_jump = 0;
  // With JumpConfig::screen: jumps as the camera of the later frame sees them, its own way left out. Of the vertices
  // with an end in the picture and none behind the eye.
  double max_jump_pixels = 0, p99_jump_pixels = 0;
  std::uint64_t vertices_in_view = 0;
  // Levels without a band (inadmissible radii) have no bound: their vertices count with ratio 0 into max_jump alone.
  // Nor has a hierarchy of one level, which has nothing to bound.
  bool bounded = true;
  // The bound of `worst` is not below its way: steps are too long for the ratio to tell a morph from an exchange.
  bool vacuous = false;
};

struct JumpConfig {
  double limit_rate = 0;           // in [0, 1): as given to LimitTracker
  bool percentiles = false;        // p99 as well: 8 to 16 bytes for every vertex that moves
  const Screen* screen = nullptr;  // of the later frame; jumps in pixels, too
  // Bound by level instead of that of jump_bounds(): what does not morph has none of its own, and is measured by that
  // of a morph. Empty: its own.
  std::span<const double> bounds{};
};

// A drawn position is off by at most three half ulps of 1 per coordinate; two frames, three coordinates: below
// 6.3e-7, doubled for positions and polynomials of s that exceed 1.
inline constexpr double jump_rounding = 1.2e-6;
// A distance is off by at most 3.5 half ulps of itself (sqrt of a sum of three squares of differences), which acts as
// if the viewpoint were off by as much: 8 * 2^-24 of the end of the band for two frames.
inline constexpr double view_rounding = 4.8e-7;

// Bound of the jump of the vertices drawn at each level (its index) between two frames, rounding of distances included.
// Infinite where the level has no band. `limit_rate` in [0, 1): as given to LimitTracker.
[[nodiscard]] std::vector<double> jump_bounds(const MorphContext& before, const MorphContext& after,
                                              double limit_rate = 0);

// Largest jump of the drawn map of M_L between two frames of one hierarchy with the same blend and metric. Exact: each
// vertex of the finer of the two drawn cells represents all vertices of M_L that arrive at it. Selections are whole
// partitions (keep_culled = true), in traversal order; throws InputError when they are not.
[[nodiscard]] PopReport largest_jump(const MorphContext& before, const Selection& selected_before,
                                     const MorphContext& after, const Selection& selected_after, Scheduler& scheduler,
                                     const JumpConfig& config = {});

// The ratio of one jump, as above.
[[nodiscard]] double jump_ratio(double jump, double bound);

}  // namespace lodestone
