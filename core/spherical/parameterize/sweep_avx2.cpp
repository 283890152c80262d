// The kernel of the map to the sphere for processors with AVX2. Only this file is compiled for them.
#include "core/spherical/parameterize/sweep_run.h"

namespace lodestone::spherical {

#if defined(__AVX2__)
const SphereKernel* const avx2_sphere_kernel = &avx2::sweep_functions;
#else
const SphereKernel* const avx2_sphere_kernel = nullptr;
#endif

}  // namespace lodestone::spherical
