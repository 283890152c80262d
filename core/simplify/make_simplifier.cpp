#include "core/simplify/make_simplifier.h"

#include <string>

#include "core/base/error.h"
#include "core/simplify/peers/cluster.h"
#include "core/simplify/peers/half_edge_simplifier.h"
#include "core/simplify/peers/meshopt_simplifier.h"
#include "core/simplify/quadric/quadric_simplifier.h"

namespace lodestone {

std::unique_ptr<Simplifier> make_simplifier(SimplifierKind kind, Placement placement) {
  if (kind != SimplifierKind::quadric && placement != Placement::endpoint)
    throw InputError(describe("", "",
                              "simplifier '" + std::string(name_of(kind)) + "' leaves its vertices where they are",
                              "only 'quadric' knows the placement 'optimal'"));
  switch (kind) {
    case SimplifierKind::cluster:
      return make_cluster_simplifier();
    case SimplifierKind::openmesh:
      return make_openmesh_simplifier();
    case SimplifierKind::meshopt:
      return make_meshopt_simplifier();
    default:
      return make_quadric_simplifier(InstructionSet::best, placement);
  }
}

}  // namespace lodestone
