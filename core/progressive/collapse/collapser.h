// The collapses of a mesh, region by region, cheapest first.
#pragma once

#include <cstddef>
#include <vector>

#include "core/progressive/collapse/collapse_kernel.h"

namespace lodestone::progressive {

class Collapser {
 public:
  Collapser(RingMesh& rings, CollapseMetric& metric, const CollapseKernel& kernel);

  // The first ranks of all vertices; may run side by side.
  void start(std::size_t begin, std::size_t end) { kernel_.start(state_, begin, end); }
  // What a vertex would cost, as of when it was looked at last; infinite: it cannot collapse.
  [[nodiscard]] float rank(Id v) const { return state_.standing[v].rank; }
  // Regions that share no vertex may run side by side, each with an arena that lives as long as the mesh.
  [[nodiscard]] std::vector<CollapseRecord> run(const Region& region, RingArena& arena) {
    return kernel_.run(state_, region, arena);
  }
  // By wedge (by vertex, without wedges): what it collapsed into; no_id: still there.
  [[nodiscard]] const std::vector<Id>& parents() const { return state_.parent; }

 private:
  const CollapseKernel& kernel_;
  CollapseState state_;
};

}  // namespace lodestone::progressive
