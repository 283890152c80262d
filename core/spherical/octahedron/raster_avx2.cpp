// The inner loops of the raster for processors with AVX2. Only this file is compiled for them.
#include "core/spherical/octahedron/raster_run.h"

namespace lodestone::spherical {

#if defined(__AVX2__)
const RasterKernel* const avx2_raster_kernel = &avx2::raster_functions;
#else
const RasterKernel* const avx2_raster_kernel = nullptr;
#endif

}  // namespace lodestone::spherical
