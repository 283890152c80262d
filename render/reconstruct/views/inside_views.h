// Views into the parts that the views from outside leave out: pockets with a narrow mouth, folds, hollows.
//
// If no map holds a sample of the surface, rays from its triangle in all directions give the distance to the nearest
// obstacle. A view that cuts the model off there, by a plane across its direction, sees the sample. A plane serves all
// samples whose stretch up to their obstacle it intersects; views are taken greedily, each time the direction and the
// plane that serve the largest number.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/views/choose_views.h"

namespace lodestone {

// True if a pixel at the point's place in the map sees the surface there. One of four is enough: at edges and borders
// the others see something else.
[[nodiscard]] bool holds_sample(const PositionMap& map, const SurfacePoint& sample);

// Views for samples that none of the maps holds. `view_along`: the orthographic view to draw along a direction, nothing
// cut off. At most choice.inside views.
[[nodiscard]] std::vector<MapView> choose_inside_views(const IndexedMesh& mesh, std::span<const SurfacePoint> samples,
                                                       std::span<const PositionMap> maps, const ViewChoice& choice,
                                                       const std::function<MapView(Vec3d)>& view_along,
                                                       Scheduler& scheduler);

}  // namespace lodestone
