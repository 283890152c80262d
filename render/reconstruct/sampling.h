// How densely a reconstruction samples the surface, and how many triangles that makes.
#pragma once

#include <cmath>

#include "render/position_map/map_view.h"
#include "render/reconstruct/reconstruct.h"

namespace lodestone {

// Spacing of the samples in the maps, normalised units. Meshes side by side are not simplified: the finer ones would
// cover each other.
[[nodiscard]] inline double map_spacing(const ReconstructConfig& config) {
  return 1 / (config.resolution * (config.merge == MergeKind::concatenate ? 1 : config.detail));
}

// At which no picture of the unit cube is too large, seen from any side.
[[nodiscard]] inline double finest_resolution(const ReconstructConfig& config) {
  const double sample = map_spacing(config) * config.resolution;  // width of one, in pixels
  return (largest_map_side - 8) * sample / (std::sqrt(3.0) * (config.condense ? 2 : 1));
}

// Triangles that are made over those that the resolution stands for, from maps that are so much finer. Cubes of
// tetrahedra give about eight triangles for one of pixels.
[[nodiscard]] inline double excess_of(const ReconstructConfig& config, double finer) {
  return config.merge == MergeKind::shell ? 8 : finer * finer;
}

}  // namespace lodestone
