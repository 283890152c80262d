// The report of a reconstruction, step by step.
#pragma once

#include <cstddef>
#include <cstdint>

#include "parallel/scheduler/clock.h"
#include "render/reconstruct/report/view_choice.h"

namespace lodestone {

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
