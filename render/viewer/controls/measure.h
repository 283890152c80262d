// Measuring a distance between two points of the surface, each set by a click.
#pragma once

#include <optional>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone::viewer {

struct Measure {
  bool on = false;            // clicks set points
  std::vector<Vec3d> points;  // of the scene, at most two; kept while it is off
  friend bool operator==(const Measure&, const Measure&) = default;
};

// The next point; the third one begins anew.
inline void add_point(Measure& measure, Vec3d point) {
  if (measure.points.size() >= 2) measure.points.clear();
  measure.points.push_back(point);
}

// In units of the scene; empty with fewer than two points.
[[nodiscard]] inline std::optional<double> distance(const Measure& measure) {
  if (measure.points.size() < 2) return {};
  return length(measure.points[1] - measure.points[0]);
}

}  // namespace lodestone::viewer
