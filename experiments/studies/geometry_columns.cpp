#include "experiments/studies/geometry_columns.h"

#include <algorithm>
#include <numbers>

#include "experiments/metrics/drawn/position_resolution.h"
#include "experiments/metrics/geometry/geometry_error.h"

namespace lodestone {

std::vector<ColumnInfo> geometry_columns() {
  using enum ColumnInfo::Kind;
  const std::string percent = "% of the diagonal";
  return {
      {"rms", percent, "distance, root of the mean square, the larger of both directions", accuracy},
      {"error_max", percent, "largest distance found, both directions", accuracy},
      {"error_mean", percent, "mean distance, the larger of both directions", accuracy},
      {"error_p99", percent, "distance that 99 % of the points do not exceed, the larger of both directions", accuracy},
      {"normal_mean", "degrees", "mean deviation of normals, the larger of both directions", accuracy},
      {"slivers", "%", "triangles whose longest edge is more than 20 times the height above it", accuracy},
  };
}

double diagonal_of(const RawMesh& mesh) {
  if (mesh.positions.empty()) return 0;
  Vec3d lower = mesh.positions.front(), upper = lower;
  for (const Vec3d& p : mesh.positions) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  return length(upper - lower);
}

void add_geometry(Row& row, const RawMesh& reference, const RawMesh& mesh, Scheduler& scheduler) {
  const GeometryError error = geometry_error(reference, mesh, {}, scheduler);
  constexpr double degrees = 180 / std::numbers::pi;
  row["rms"] = 100 * resolved(error.rms);
  row["error_max"] = 100 * resolved(error.hausdorff);
  row["error_mean"] = 100 * resolved(error.mean);
  row["error_p99"] = 100 * resolved(error.p99);
  row["normal_mean"] = degrees * resolved(std::max(error.normals.forward.mean, error.normals.backward.mean) / degrees);
  row["slivers"] = 100 * error.quality.sliver_share();
}

void check_geometry(RowVerdict& verdict) {
  verdict.in_order("error_mean", "rms");
  verdict.in_order("rms", "error_max");
  verdict.in_order("error_p99", "error_max");
  verdict.at_most("slivers", 100);
  verdict.at_most("normal_mean", 180);
}

}  // namespace lodestone
