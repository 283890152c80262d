// Detail limits: drawing without a crack or a pop while finer cells are missing.
//
// An ancestor drawn in the place of a missing cell would crack: its neighbours' vertices are elsewhere. Instead,
// selection and morph both take the distance
//
//     d'(x) = max(d(v_p, x), max over limits of R - d(x, Q)),
//
// Q a box and R a radius: as if the viewpoint kept away from Q. It is 1-Lipschitz in x as d is, so that everything
// proved for d holds for d'. A limit on the bounds of a cell Q of level l with R = r_l makes d' at least r_l all over
// Q: the cell is never refined. When R sinks slowly after the finer cells have come, they appear at their parents'
// places (lambda = 0) and move on from there: d' changes by no more than R does.
//
// Adaptive radii measure boxes alone: a limit on Q with R = R_Q keeps Q from being refined, and d' of a box is at most
// that of a box inside it, and at least that less the overhang of it: all that their proof needs of d (decision 55).
//
// The excess of a limit, R - d(v_p, Q), decreases geometrically. Where a limit of excess e is larger than d, d' is
// at least e / 2 (for d' >= d(v_p, x) and d' >= R - d(x, Q) >= e - d(v_p, x)). A step of e by a given share thus
// changes d' by at most twice that share, everywhere: near the viewpoint, where bands are narrow, by little.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/radii.h"

namespace lodestone {

// d' of a point.
[[nodiscard]] float limited_distance(DistanceMetric metric, Vec3f viewpoint, Vec3f p, DetailLimits limits);

// A lower bound of d' in the box, exact without limits: max(min of d, max over limits of the min of R - d(x, Q)). In
// float no larger than d' of any point of the box, and no smaller for a box inside it.
[[nodiscard]] float limited_distance(DistanceMetric metric, Vec3f viewpoint, const Box3f& box, DetailLimits limits);

// An upper bound of d' in the box.
[[nodiscard]] float limited_farthest_distance(DistanceMetric metric, Vec3f viewpoint, const Box3f& box,
                                              DetailLimits limits);

// Appends to `out` the limits that may exceed d somewhere in the box; those left out change no bit of d' there.
void limits_near(DistanceMetric metric, Vec3f viewpoint, const Box3f& box, DetailLimits limits,
                 std::vector<DetailLimit>& out);

// Tells if the children of a cell are available to replace it.
enum class ChildState : std::uint8_t {
  there,     // and they are kept
  unwanted,  // there, but to go: the limit rises until they are no longer drawn
  missing,
};

// The limits of a sequence of frames. Children may be taken away without a pop when their parent, of level l, was not
// refined in the last frame: when limited_distance of its bounds was at least r_l.
class LimitTracker {
 public:
  using ChildStateOf = std::function<ChildState(CellId cell)>;

  // Limits for a frame from this viewpoint: one for every cell that d asks to refine and whose children are missing
  // (R: its radius), and those that sink or rise after a change. `rate` in [0, 1]: share of its excess that a limit
  // loses in a frame (one that rises gains as much); 1: at once, which pops; 0: nothing that was missing ever appears.
  // Returns false if the limits are those of the last frame, bit by bit.
  bool update(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, const ChildStateOf& child_state,
              float rate);

  [[nodiscard]] DetailLimits limits() const { return limits_; }

  // Cells whose children are missing and needed by d, in traversal order.
  [[nodiscard]] std::span<const CellId> missing() const { return missing_; }

 private:
  class Update;
  std::vector<DetailLimit> limits_;
  std::vector<CellId> limited_, missing_;  // limited_: the cells of limits_
  std::vector<float> radius_;              // by cell; 0 without a limit
};

}  // namespace lodestone
