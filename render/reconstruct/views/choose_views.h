// Chooses the views of a model: the six faces of its box, and others that its uncovered area needs.
//
// Everything that can be seen from outside is seen by some parallel projection, so candidates are directions: the six
// faces and a sphere of others. The samples of the surface that the faces see, and the angles, are found by drawing at
// a low resolution; a sample that they see badly or not at all is tested along rays from 64 directions, and from every
// candidate what those see no better. Of a mesh of many more triangles than pixels a coarse copy (coarse_copy.h) is
// drawn and stands in the way of the rays, so that the time grows little with the triangles. Then views are taken
// greedily, each time the one that improves the largest number of samples.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/report/report.h"

namespace lodestone {

[[nodiscard]] std::vector<Vec3d> face_directions();
// Evenly spread over the sphere (a Fibonacci lattice).
[[nodiscard]] std::vector<Vec3d> sphere_directions(int count);

// The faces and others evenly spread, `count` in all, whatever the model: nothing is measured. Fewer than six are
// spread over the sphere.
[[nodiscard]] std::vector<Vec3d> even_directions(int count);

[[nodiscard]] ChosenViews choose_views(const IndexedMesh& mesh, const ViewChoice& choice, Scheduler& scheduler);

}  // namespace lodestone
