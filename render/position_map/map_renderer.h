// Drawing position maps of one mesh, by either backend.
#pragma once

#include <memory>
#include <string_view>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler.h"
#include "render/position_map/position_map.h"

namespace lodestone {

class MapRenderer {
 public:
  virtual ~MapRenderer() = default;
  // Throws InputError for a view that check_view refuses or that has vertices behind its eye, UnsupportedError for one
  // that is larger than the backend's pictures.
  [[nodiscard]] virtual PositionMap draw(const MapView& view, MapChannels channels) = 0;
};

// "soft" (rasterize_map) or "gl" (float targets of OpenGL). Pixels that see the same triangle have the same bytes; at
// edges and silhouettes OpenGL may choose the neighbour, since it projects in single precision. Throws InputError for
// another name, UnsupportedError with what is missing when the backend cannot run here, ResourceError when the mesh
// does not fit. Mesh and scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<MapRenderer> make_map_renderer(std::string_view backend, const IndexedMesh& mesh,
                                                             Scheduler& scheduler);

}  // namespace lodestone
