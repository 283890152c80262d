// Chooses the views of a model: the six faces of its box, and others that its uncovered area needs.
//
// Everything that can be seen from outside is seen by some parallel projection, so candidates are directions: the six
// faces and a sphere of others. The samples of the surface that the faces see, and the angles, are found by drawing at
// a low resolution; a sample that they see badly or not at all is tested along rays from 64 directions, and from every
// candidate what those see no better. Of a mesh of many more triangles than pixels a coarse copy (coarse_copy.h) is drawn
// and stands in the way of the rays, so that the time grows little with the triangles. Then views are taken greedily,
// each time the one that improves the largest number of samples.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"

namespace lodestone {

struct ViewChoice {
  int most = 30;               // views in all
  int least = 6;               // the faces, of which the first are taken unconditionally; fewer: greedy from the start
  double coverage = 0.9995;    // sufficient share of the samples that the candidates can cover
  double least_gain = 0.0002;  // of the area: a view that covers less is not worth drawing
  float least_cosine = 0.5f;   // between surface and view: below, an area is covered by a part of itself, in proportion
  int candidates = 512;        // directions besides the faces
  std::uint64_t samples = 30'000;  // of the surface, at most; reconstruct() takes fewer for few pixels
  int resolution = 256;            // pixels along the box's longest side, of the faces' maps; likewise
  int inside = 12;                 // further views, with obstacles cut off (inside_views.h); 0: none

  // The six faces and no others: nothing needs to be measured.
  [[nodiscard]] bool prescribes_faces() const { return most == 6 && least == 6 && inside == 0; }
};

struct SurfacePoint {
  Vec3d point;  // normalised model space
  Vec3f normal;
  std::uint32_t triangle = 0;
};

struct ChosenViews {
  std::vector<Vec3d> directions;  // in which the views look, of unit length
  // Shares of the area, by samples: seen by any candidate at all; under least_cosine or better by any; by those chosen.
  double visible = 0, coverable = 0, covered = 0;
  std::vector<SurfacePoint> samples;  // all of them
  std::vector<Vec3d> visible_points;  // those that some candidate sees, normalised model space
  std::vector<MapView> inside;        // views with obstacles cut off
};

[[nodiscard]] std::vector<Vec3d> face_directions();
// Evenly spread over the sphere (a Fibonacci lattice).
[[nodiscard]] std::vector<Vec3d> sphere_directions(int count);

// The faces and others evenly spread, `count` in all, whatever the model: nothing is measured. Fewer than six are
// spread over the sphere.
[[nodiscard]] std::vector<Vec3d> even_directions(int count);

[[nodiscard]] ChosenViews choose_views(const IndexedMesh& mesh, const ViewChoice& choice, Scheduler& scheduler);

}  // namespace lodestone
