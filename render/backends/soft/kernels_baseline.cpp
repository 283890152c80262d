#include "render/backends/soft/raster_kernel.h"
#include "render/backends/soft/resolve_kernel.h"
#include "render/backends/soft/setup_kernel.h"
#include "render/backends/soft/vertex_kernel.h"

namespace lodestone::soft::baseline {

const Kernels kernels{
    transform_cell, count_triangles, {setup_run<1>, draw_triangles<1>, resolve<1>},
    {setup_run<4>, draw_triangles<4>, resolve<4>}};

}  // namespace lodestone::soft::baseline
