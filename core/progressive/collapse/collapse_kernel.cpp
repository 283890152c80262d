#include "core/progressive/collapse/collapse_kernel.h"

namespace lodestone::progressive {

const CollapseKernel& collapse_kernel(InstructionSet set) {
  return *choose_kernel(set, plain_collapse_kernel, avx2_collapse_kernel);
}

Collapser::Collapser(RingMesh& rings, CollapseMetric& metric, const CollapseKernel& kernel)
    : kernel_(kernel),
      state_{.rings = rings,
             .metric = metric,
             .vertices = std::vector<VertexState>(rings.vertex_count()),
             .parent = std::vector<Id>(rings.vertex_count(), no_id)} {}

}  // namespace lodestone::progressive
