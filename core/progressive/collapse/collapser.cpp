#include "core/progressive/collapse/collapser.h"

namespace lodestone::progressive {

Collapser::Collapser(RingMesh& rings, CollapseMetric& metric, const CollapseKernel& kernel)
    : kernel_(kernel),
      state_{.rings = rings,
             .metric = metric,
             .standing = std::vector<Standing>(rings.vertex_count()),
             .parent = std::vector<Id>(rings.vertex_count(), no_id)} {}

const CollapseKernel& collapse_kernel(InstructionSet set) {
  return *choose_kernel(set, &plain_collapse_kernel, &avx2_collapse_kernel);
}

}  // namespace lodestone::progressive
