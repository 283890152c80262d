// The functions of the collapse kernel for one kind of lanes.
#pragma once

#include "core/progressive/collapse/collapse_lanes.h"
#include "core/progressive/collapse/star_quadrics.h"

namespace lodestone::progressive {

template <class L>
constexpr CollapseKernel kernel_of() {
  return {.chain = chain_eight<L>,
          .star_quadrics =
              [](const RingMesh& rings, std::size_t begin, std::size_t end, PlaneQuadric* quadrics) {
                for (std::size_t k = begin; k < end; ++k) {
                  const auto v = static_cast<Id>(k);
                  const Ring& ring = rings.ring(v);
                  bool simple = ring.open == 0 && ring.size <= 8 && ring.size > 0;
                  if (rings.has_wedges())
                    for (std::uint32_t i = 1; i < ring.size; ++i) simple = simple && ring.wedge(i) == ring.wedge(0);
                  quadrics[k] = simple ? closed_star_quadric<L>(load_star<L, 1>(rings.points(), ring, v), ring.size)
                                       : star_quadric(rings, v);
                }
              },
          .start = [](CollapseState& state, std::size_t begin,
                      std::size_t end) { CollapseRun<L>(state).start(begin, end); },
          .run = [](CollapseState& state, const Region& region,
                    RingArena& arena) { return CollapseRun<L>(state).run(region, arena); }};
}

}  // namespace lodestone::progressive
