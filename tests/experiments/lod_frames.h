// Frames of a hierarchy for the tests of the metrics: radii, viewpoints, selections.
#pragma once

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/morph.h"
#include "render/lod/radii.h"
#include "render/lod/selection.h"

namespace lodestone::testing {

inline constexpr DistanceMetric both_metrics[] = {DistanceMetric::euclidean, DistanceMetric::chebyshev};

inline Radii uniform_radii(const Hierarchy& hierarchy, DistanceMetric metric, float kappa0) {
  RadiiConfig config;
  config.rule = RadiiRule::uniform;
  config.metric = metric;
  config.kappa0 = kappa0;
  return make_radii(hierarchy, config);
}

inline Radii per_level_radii(const Hierarchy& hierarchy, DistanceMetric metric, float kappa0 = 0.5f) {
  RadiiConfig config;
  config.metric = metric;
  config.kappa0 = kappa0;
  return make_radii(hierarchy, config);
}

struct Frame {
  MorphContext context;
  Selection selection;
};

inline Frame make_frame(const Hierarchy& hierarchy, const Radii& radii, Blend blend, Vec3f viewpoint) {
  Frame frame{{&hierarchy, &radii, blend, viewpoint}, {}};
  select_cells(hierarchy, radii, viewpoint, {}, frame.selection);
  return frame;
}

// Viewpoints at distances between 1e-4 and 8 of random vertices, every fifth one on the vertex itself, every seventh
// one on a corner of the finest grid.
inline std::vector<Vec3f> random_viewpoints(const Hierarchy& hierarchy, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::normal_distribution<float> normal;
  const auto leaves = hierarchy.cells_of(hierarchy.finest());
  std::vector<Vec3f> views;
  for (int i = 0; i < count; ++i) {
    const Cell& leaf = leaves[random() % leaves.size()];
    const Vec3f near = leaf.positions[random() % leaf.positions.size()];
    const Vec3f way{normal(random), normal(random), normal(random)};
    const float distance = std::pow(10.0f, -4 + 4.9f * unit(random));
    if (i % 5 == 4) {
      views.push_back(near);
    } else if (i % 7 == 6) {
      const float n = 1 / cell_size(hierarchy.finest());
      views.push_back({std::round(near.x * n) / n, std::round(near.y * n) / n, std::round(near.z * n) / n});
    } else {
      views.push_back(near + distance / length(way) * way);
    }
  }
  return views;
}

}  // namespace lodestone::testing
