// Position maps by OpenGL: which triangle a pixel sees is found by the depth test, and a second pass fills float
// targets with what resolve_pixel.h computes, in double precision, so that the bytes are those of the soft rasterizer.
#pragma once

#include <memory>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"

namespace lodestone {

// Draws as make_map_renderer's renderers do. Positions and triangles must fit into storage blocks of the driver (128
// MiB each on llvmpipe: ten million triangles).
[[nodiscard]] std::unique_ptr<MapRenderer> make_gl_map_renderer(const IndexedMesh& mesh, Scheduler& scheduler);

}  // namespace lodestone
