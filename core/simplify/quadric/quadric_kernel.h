// The quadric kernel: half-edge collapse on rings of 16-bit ids with a lazy queue (decision 0002).
//
// Based on quadric error metrics (garland1997), half-edge collapses under the link condition (dey1999) and a bucket
// queue. Different from the usual: no triangle list, every test of a vertex in eight lanes at once, and costs that are
// computed only when a vertex comes up. Compiled once for each instruction set; every build gives the same bytes.
#pragma once

#include "core/simplify/quadric/distances.h"
#include "core/simplify/quadric/fan_collapse.h"
#include "core/simplify/quadric/first_costs.h"
#include "core/simplify/quadric/relocate.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

inline void simplify_block(const SimplifyInput& input, Placement placement, const BlockMemory& memory,
                           SimplifyResult& result) {
  Block b{input,        memory.arrays, memory.nonmanifold,
          memory.seams, result,        static_cast<unsigned>(input.positions.size())};
  place_points(b);
  link_triangles(b);
  start_vertices(b);
  collapse_to_target(b);
  if (placement == Placement::optimal) relocate_survivors(b);
  measure_distances(b);
  result.triangles = b.live;
  if (b.seams != nullptr) b.seams->resolve(input, result.parent, result.wedge_parent);
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
