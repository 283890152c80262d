#include "core/simplify/make_simplifier.h"

#include <string>

#include "core/base/error.h"
#include "core/simplify/peers/peers.h"
#include "core/simplify/quadric/quadric_simplifier.h"

namespace lodestone {

std::unique_ptr<Simplifier> make_simplifier(SimplifierKind kind, Placement placement) {
  if (kind != SimplifierKind::quadric && placement != Placement::endpoint)
    throw InputError(describe("", "", "simplifier '" + std::string(name_of(kind)) + "' does not move its vertices",
                              "use the placement 'endpoint', or the simplifier 'quadric'"));
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
