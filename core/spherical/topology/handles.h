// Closes the handles of a surface: cuts along short loops that do not separate it, and caps both sides.
//
// The shortest such loop is cut first, as erickson2005 choose their generators and wood2004 their handles. Both look
// for it from every vertex; here balls grow from few vertices at once, within a bound of the shortest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/runner.h"
#include "core/spherical/surface.h"
#include "core/spherical/topology/ball_search.h"

namespace lodestone::spherical {

struct HandleConfig {
  // Distance of a loop from the centre of the nearest ball, as a share of the ball's radius, 0 to 1. With 0 balls grow
  // from every seed and each loop is the shortest one. With 0.5 it takes up to fifty times less where loops are
  // long, and they are 0 to 1.5 % longer altogether.
  double slack = 0.5;
};

struct ClosedHandles {
  std::vector<double> lengths;  // of the loops, in the order of the cuts
  std::uint64_t cap_triangles = 0;
};

// Closed, oriented, manifold, one component, at most one edge between two vertices; so is the result, of genus 0.
// `memory` has one for each worker, `worker` is the caller's own.
[[nodiscard]] ClosedHandles close_handles(Surface& surface, const HandleConfig& config, const Runner& runner,
                                          std::vector<BallSearch>& memory, std::size_t worker);

}  // namespace lodestone::spherical
