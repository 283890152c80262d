#include "core/spherical/parameterize/sphere_kernel.h"

namespace lodestone::spherical {

const SphereKernel& sphere_kernel(InstructionSet set) {
  return *choose_kernel(set, plain_sphere_kernel, avx2_sphere_kernel);
}

}  // namespace lodestone::spherical
