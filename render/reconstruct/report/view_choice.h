// Configuration and result of choosing views.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "render/position_map/map_view.h"

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

  friend bool operator==(const ViewChoice&, const ViewChoice&) = default;

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

}  // namespace lodestone
