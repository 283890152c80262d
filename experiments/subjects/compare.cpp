#include "experiments/subjects/compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"
#include "experiments/metrics/drawn/position_resolution.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/compare.h"
#include "parallel/mesh/load.h"

namespace lodestone {
namespace {

int level_number(const SurfaceName& name, const Hierarchy& hierarchy) {
  if (!name.level) return hierarchy.finest();
  const std::string& number = *name.level;
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos || number.size() > 2 ||
      std::stoi(number) > hierarchy.finest())
    throw InputError(describe(name.file, "", "there is no level '" + number + "'",
                              fmt::format("the levels are 0 to {}", hierarchy.finest())));
  return std::stoi(number);
}

// Triangles with a corner that is not finite are left out and counted.
RawMesh read_surface(const SurfaceName& name, const ReadConfig& reading, Scheduler& scheduler,
                     std::uint64_t& non_finite) {
  if (name.hierarchy) {
    const Hierarchy hierarchy = load_lode(name.file, scheduler);
    return level_mesh(hierarchy, level_number(name, hierarchy));
  }
  RawMesh mesh = load_mesh(name.file, scheduler, reading);
  non_finite = std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return !std::all_of(t.v.begin(), t.v.end(), [&](auto v) { return is_finite(mesh.positions[v]); });
  });
  if (mesh.triangles.empty())
    throw InputError(describe(name.file, "", "every triangle has a corner that is not finite"));
  return mesh;
}

using enum ColumnInfo::Kind;

// A distance, the larger of both directions, in percent of the diagonal.
std::function<Row(const MeshDistance&)> percent_of(double DirectedDistance::*distance) {
  return [distance](const MeshDistance& d) {
    const double larger = std::max(d.forward.*distance, d.backward.*distance);
    return Row(d.diagonal > 0 ? 100 * resolved(larger / d.diagonal) : 0.0);
  };
}

const std::vector<Column<MeshDistance>>& all_distance_columns() {
  static const std::string percent = "% of the diagonal";
  static const std::vector<Column<MeshDistance>> list{
      {{"rms", percent, "distance, root of the mean square, the larger of both directions", accuracy},
       percent_of(&DirectedDistance::rms)},
      {{"error_max", percent, "largest distance found, both directions", accuracy}, percent_of(&DirectedDistance::max)},
      {{"error_mean", percent, "mean distance, the larger of both directions", accuracy},
       percent_of(&DirectedDistance::mean)},
      {{"error_p99", percent, "distance that 99 % of the points do not exceed, the larger of both directions",
        accuracy},
       percent_of(&DirectedDistance::p99)},
  };
  return list;
}

}  // namespace

SurfaceName::SurfaceName(const std::string& name) : file(name) {
  const std::size_t at = name.rfind(".lode"), end = at + 5;
  hierarchy = at != std::string::npos && (end == name.size() || name[end] == ':');
  if (!hierarchy || end == name.size()) return;
  file = name.substr(0, end), level = name.substr(end + 1);
}

CompareResult run(const CompareJob& job, Scheduler& scheduler) {
  CompareResult result;
  job.on_phase("reading");
  const RawMesh a = read_surface(job.a, job.reading, scheduler, result.non_finite_triangles[0]);
  const RawMesh b = read_surface(job.b, job.reading, scheduler, result.non_finite_triangles[1]);
  job.on_phase("comparing");
  result.distance = compare_meshes(a, b, job.config, scheduler);
  result.warnings = a.warnings;
  result.warnings.insert(result.warnings.end(), b.warnings.begin(), b.warnings.end());
  return result;
}

std::vector<ColumnInfo> distance_columns() { return infos_of(all_distance_columns()); }

Row to_row(const MeshDistance& distance) { return row_of(all_distance_columns(), distance); }

std::vector<ColumnInfo> geometry_columns() {
  std::vector<ColumnInfo> list = distance_columns();
  append(list, {{"normal_mean", "degrees", "mean deviation of normals, the larger of both directions", accuracy},
                {"slivers", "%", "triangles whose longest edge is more than 20 times the height above it", accuracy}});
  return list;
}

Row to_row(const GeometryError& error) {
  constexpr double degrees = 180 / std::numbers::pi;
  Row row = to_row(error.distance);
  row["normal_mean"] = degrees * resolved(std::max(error.normals.forward.mean, error.normals.backward.mean) / degrees);
  row["slivers"] = 100 * error.quality.sliver_share();
  return row;
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

Json to_json(const DirectedDistance& d) {
  return {{"max", d.max}, {"rms", d.rms}, {"mean", d.mean}, {"p99", d.p99}, {"samples", d.samples}};
}

}  // namespace lodestone
