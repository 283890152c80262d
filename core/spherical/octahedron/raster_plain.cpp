// The inner loops of the raster for any processor.
#include "core/spherical/octahedron/raster_run.h"

namespace lodestone::spherical {

const RasterKernel* const plain_raster_kernel = &plain::raster_functions;

}  // namespace lodestone::spherical
