#include "render/backends/soft/layers_kernel.h"
#include "render/backends/soft/occlusion_kernel.h"
#include "render/backends/soft/raster_kernel.h"
#include "render/backends/soft/resolve_kernel.h"
#include "render/backends/soft/setup_kernel.h"
#include "render/backends/soft/vertex_kernel.h"

namespace lodestone::soft::plain {

const Kernels kernels{transform_cell,
                      occlude,
                      {setup_run<1>, draw_triangles<1>, count_triangles<1>, resolve<1>, collect_layers<1>,
                       shade_layer<1>, resolve_layered<1>},
                      {setup_run<4>, draw_triangles<4>, count_triangles<4>, resolve<4>, collect_layers<4>,
                       shade_layer<4>, resolve_layered<4>}};

}  // namespace lodestone::soft::plain
