// The backends, by name: ours, and those that a program adds.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/renderer.h"

namespace lodestone {

class MapRenderer;  // render/position_map/position_map.h

// The functions that make a backend's renderers; empty ones for frames or maps that it does not draw. Both may throw
// UnsupportedError, naming the part that is missing here. Scheduler and mesh outlive what is returned.
struct BackendInfo {
  std::function<std::unique_ptr<Renderer>(Scheduler&)> frames = {};
  std::function<std::unique_ptr<MapRenderer>(const IndexedMesh&, Scheduler&)> maps = {};
  bool pictures = true;  // frames have a picture and a depth
};

// Makes a backend known to make_renderer, make_map_renderer and every --backend. Throws InputError for a name that is
// taken or cannot be one (core/base/registry.h), and for an info without functions. To be called before any is used.
void add_backend(const std::string& name, BackendInfo info);

// "soft", "gl", "null", and what was added; those that give pictures; those that draw maps.
[[nodiscard]] std::vector<std::string> backend_names();
[[nodiscard]] std::vector<std::string> picture_backend_names();
[[nodiscard]] std::vector<std::string> map_backend_names();

// Throws InputError for another name than backend_names(), UnsupportedError (naming the missing part) when the backend
// cannot run here. The scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<Renderer> make_renderer(std::string_view backend, Scheduler& scheduler);

// "soft" (rasterize_map), "gl" (float targets of OpenGL), or what was added. Pixels of the two that see the same
// triangle have the same bytes; at edges and silhouettes OpenGL may choose the neighbour, since it projects in single
// precision. Throws InputError for another name than map_backend_names(), UnsupportedError naming the missing part when
// the backend cannot run here, ResourceError when the mesh does not fit. Mesh and scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<MapRenderer> make_map_renderer(std::string_view backend, const IndexedMesh& mesh,
                                                             Scheduler& scheduler);

}  // namespace lodestone
