// The choice of views, and the report of a reconstruction, step by step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "parallel/scheduler/clock.h"
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

struct StitchReport {
  std::size_t islands = 0;  // pixels of a view that are in none of its triangles
  std::size_t zipped = 0;   // triangles between pieces
  std::size_t holes_filled = 0, hole_triangles = 0, holes_open = 0;
  double longest_filled = 0;       // perimeter of a hole, normalised units
  double open_length = 0;          // of all borders that are left, normalised units
  std::size_t handles = 0;         // that zipping has made
  std::size_t crumbs = 0;          // triangles of pieces that were left out
  std::size_t vertices_split = 0;  // where surfaces touched in a vertex
  std::size_t collapsed = 0, flipped = 0;
  StageTime own, zip;  // choosing and gathering; from zipping on
};

struct ShellReport {
  std::size_t grid_points = 0;
  std::size_t sheet_points = 0;  // that stand for parts thinner than the spacing
  std::size_t cavities = 0;      // surfaces of closed hollows, left out
  std::size_t crumbs = 0;        // components smaller than two spacings, left out
};

struct SharpenReport {
  std::size_t edges = 0, corners = 0;  // new vertices
};

struct LostParts {
  std::size_t parts = 0, triangles = 0;
};

struct ReconstructReport {
  ChosenViews views;
  double spacing = 0;                  // of the resolution, normalised units
  double drawn_resolution = 0;         // pixels; `spacing` is larger where fewer triangles were asked for
  double map_spacing = 0;              // of the samples in maps that were drawn here, normalised units
  std::uint64_t pixels = 0, seen = 0;  // of all maps
  std::uint64_t view_triangles = 0;    // of all view meshes
  StitchReport stitch;
  SharpenReport sharpen;
  LostParts lost;
  ShellReport shell;
  std::size_t sampled_triangles = 0;  // before they were simplified
  bool closed = false;                // the input has no border
  bool oriented = false;              // and its triangles agree on the outside
  StageTime choose, draw, connect, merge, sharpen_time, attributes, simplify;
};

}  // namespace lodestone
