// The kernel of the map to the sphere for any processor.
#include "core/spherical/parameterize/sweep_run.h"

namespace lodestone::spherical {

const SphereKernel* const plain_sphere_kernel = &plain::sweep_functions;

}  // namespace lodestone::spherical
