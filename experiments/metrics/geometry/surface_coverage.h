// Share of a surface that another one covers, by points of what can be seen of it.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Pictures of a surface from outside, from all around: directions spread evenly over the sphere, parallel rays in each
// spread evenly over the disc that holds the model.
struct Pictures {
  int directions = 256;
  int rays = 256;  // in each direction
};

// The first point of the mesh that each ray meets, normalised space: what pixels show that are chosen at random from
// pictures of all directions. A part of the surface has points in proportion to its area in all of these pictures: by
// the share of the directions that see it, and by the cosine under which they do. None for a mesh without triangles.
// Same bytes for any number of workers.
[[nodiscard]] std::vector<Vec3d> points_in_pictures(const IndexedMesh& mesh, const Pictures& pictures,
                                                    Scheduler& scheduler);

struct SurfaceCoverage {
  double share = 0;         // of the points that have a point of the mesh within the distance
  double rms = 0, max = 0;  // of the points' distances from the mesh, normalised units
};

// Points are in normalised space, `distance` in normalised units. A mesh without triangles covers nothing, at infinite
// distance; no points are covered, at distance 0. Same bytes for any number of workers.
[[nodiscard]] SurfaceCoverage measure_coverage(std::span<const Vec3d> points, const RawMesh& mesh,
                                               const Transform& transform, double distance, Scheduler& scheduler);

}  // namespace lodestone
