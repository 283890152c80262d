// Views into what the views from outside leave out: pockets behind a narrow mouth, folds, hollows.
//
// Where no map holds a sample of the surface, its triangle is looked at from every side along rays: how far it is to
// what is in the way. A view that cuts the model off there, by a plane across its direction, sees the sample. A plane
// serves all samples whose stretch up to what is in their way it meets; views are taken greedily, each time the
// direction and the plane that serve the most.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/choose_views.h"

namespace lodestone {

// Whether a pixel at the point's place in the map is one of the surface there. One of four is enough: at edges and
// borders the others see something else.
[[nodiscard]] bool holds_sample(const PositionMap& map, const SurfacePoint& sample);

// For samples that none of the maps holds. `view_along`: the view to draw along a direction, nothing cut off;
// orthographic. At most choice.inside views.
[[nodiscard]] std::vector<MapView> choose_inside_views(const IndexedMesh& mesh, std::span<const SurfacePoint> samples,
                                                       std::span<const PositionMap> maps, const ViewChoice& choice,
                                                       const std::function<MapView(Vec3d)>& view_along,
                                                       Scheduler& scheduler);

}  // namespace lodestone
