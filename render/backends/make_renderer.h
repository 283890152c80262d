// Chooses among the backends.
#pragma once

#include <memory>
#include <string_view>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/renderer.h"

namespace lodestone {

class MapRenderer;  // render/position_map/map_renderer.h

// "soft", "gl", "null". Throws InputError for another name, UnsupportedError (naming the missing part) when the backend
// cannot run here. The scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<Renderer> make_renderer(std::string_view backend, Scheduler& scheduler);

// "soft" (rasterize_map) or "gl" (float targets of OpenGL). Pixels that see the same triangle have the same bytes; at
// edges and silhouettes OpenGL may choose the neighbour, since it projects in single precision. Throws InputError for
// another name, UnsupportedError naming the missing part when the backend cannot run here, ResourceError when the mesh
// does not fit. Mesh and scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<MapRenderer> make_map_renderer(std::string_view backend, const IndexedMesh& mesh,
                                                             Scheduler& scheduler);

}  // namespace lodestone
