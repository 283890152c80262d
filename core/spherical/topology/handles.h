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
#include "core/spherical/topology/report.h"

namespace lodestone::spherical {

struct ClosedHandles {
  std::vector<double> lengths;  // of the loops, in the order of the cuts
  std::uint64_t cap_triangles = 0;
};

// Closed, oriented, manifold, one component, at most one edge between two vertices; so is the result, of genus 0.
// `memory` has one for each worker, `worker` is the caller's own.
[[nodiscard]] ClosedHandles close_handles(Surface& surface, const HandleConfig& config, const Runner& runner,
                                          std::vector<BallSearch>& memory, std::size_t worker);

}  // namespace lodestone::spherical
