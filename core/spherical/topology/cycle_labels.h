// Labels of edges that tell which cycles of a surface separate it (eppstein2003, erickson2005).
//
// The labels round every face cancel each other out under exclusive or, so that a cycle which bounds a part of the
// surface has the label 0, and cycles that differ by such a one have the same label.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "core/spherical/topology/ball_search.h"
#include "core/spherical/topology/surface_graph.h"

namespace lodestone::spherical {

// 2 * genus loops that generate all others, each a chain of vertices; every cycle that does not separate the surface
// meets one of them.
using Generators = std::vector<std::vector<Id>>;

// The most cuts after which the labels still serve: new ones are needed then.
inline constexpr std::size_t most_cuts = 44;

// Labels all links, and returns the generators: the loops that the edges outside a shortest-path tree, and a maximum
// spanning tree of the faces, close. With genus up to 32 labels are exact. Beyond, they are random words, so
// that a cycle which does not separate may very rarely look as if it did; never the other way round.
// n log n; 40 bytes per edge.
[[nodiscard]] Generators label_cycles(SurfaceGraph& graph, BallSearch& search, std::mt19937_64& random);

}  // namespace lodestone::spherical
