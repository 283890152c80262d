#include "core/progressive/collapse/collapser.h"

#include "core/base/error.h"

namespace lodestone::progressive {

Collapser::Collapser(RingMesh& rings, CollapseMetric& metric, const CollapseKernel& kernel)
    : kernel_(kernel),
      state_{.rings = rings,
             .metric = metric,
             .standing = std::vector<Standing>(rings.vertex_count()),
             .parent = std::vector<Id>(rings.vertex_count(), no_id)} {}

const CollapseKernel& collapse_kernel(InstructionSet set) {
  if (!is_available(set))
    throw UnsupportedError(describe("", "collapse kernel", "this processor has no AVX2", "use the plain kernel"));
  return set != InstructionSet::plain && is_available(InstructionSet::avx2) ? avx2_collapse_kernel
                                                                            : plain_collapse_kernel;
}

}  // namespace lodestone::progressive
