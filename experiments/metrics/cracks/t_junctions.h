// T-junctions: a vertex of one border that lies inside an edge of another one, as where a fine and a coarse part of a
// surface meet without sharing the edge. A crack opens there as soon as anything is rounded or moves.
#pragma once

#include <cstdint>
#include <span>

#include "core/math/vec3.h"
#include "parallel/scheduler/scheduler.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

// The tolerance of the experiments, over h of the finest level. There is no sharp limit between a vertex on an edge and
// one that misses it. Of 33 frames that crack (sphere, terrain and a scan; no morph, or radii of 0.3 and 0.8 of the
// border) none has a border vertex within 1e-4 of another border edge, since parents are vertices and no points of
// edges; half of the frames have 6 % or more of them within 0.01, 19 % within 0.03, and fewer again within 0.1, which
// is longer than an edge of the finest level. 0.01 is a fifth of such an edge and less. Frames that do not crack have
// none up to 0.3.
inline constexpr double junction_tolerance = 0.01;

struct TJunctionReport {
  std::uint64_t junctions = 0;     // pairs of a vertex and an edge
  std::uint64_t vertices = 0;      // border vertices that lie on an edge, each counted once
  std::uint64_t border_edges = 0;  // looked at
  double worst = 0;                // largest distance of such a vertex from its edge, units of the positions
  Vec3d where;                     // of the vertex of `worst`, or of the first one
};

// Border edges are those of the boundary of the oriented triangles, welded by the values of their positions
// (-0 = +0). A vertex of a border edge lies on another border edge when it is none of its ends, its distance from the
// edge is at most `tolerance`, and the nearest point of the edge is farther than that from both of its ends. tolerance
// >= 0, in units of the positions; throws InputError otherwise, and for positions that are not finite.
//
// O(n log n) for a tolerance that is small against the edges; the same bytes for any number of workers.
[[nodiscard]] TJunctionReport t_junctions(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                          double tolerance, Scheduler& scheduler);

// T-junctions of a drawn frame before culling; tolerance in normalised units. A fine vertex that a morph has not
// brought to its coarse neighbours is off by up to sigma0 h_l / 2: the tolerance says what still counts as lying on the
// edge.
[[nodiscard]] TJunctionReport t_junctions(const MorphContext& context, const Selection& selection, double tolerance,
                                          Scheduler& scheduler);

}  // namespace lodestone
