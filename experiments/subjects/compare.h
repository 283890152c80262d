// The subject `compare`: how far two surfaces are from each other, both ways.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/spatial/mesh_distance.h"
#include "experiments/metrics/geometry/geometry_error.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// "scan.ply", or "scan.lode", or "scan.lode:3" for a level of a hierarchy.
struct SurfaceName {
  explicit SurfaceName(const std::string& name);
  std::string file;
  bool hierarchy = false;
  std::optional<std::string> level;  // as given; none: the finest one
};

struct CompareJob {
  SurfaceName a, b;
  ReadConfig reading{};
  CompareConfig config{};
  std::function<void(const std::string& phase)> on_phase = [](const std::string&) {};
};

struct CompareResult {
  MeshDistance distance;
  std::array<std::uint64_t, 2> non_finite_triangles{};  // left out of each, as `build` does
  std::vector<std::string> warnings;
};

// Throws what reading throws, InputError for a level that the hierarchy does not have or a mesh without finite
// triangle.
[[nodiscard]] CompareResult run(const CompareJob& job, Scheduler& scheduler);

// Columns of distances both ways, and of everything that geometry_error measures. A distance below position_resolution
// is 0.
[[nodiscard]] std::vector<ColumnInfo> distance_columns();
[[nodiscard]] Row to_row(const MeshDistance& distance);
[[nodiscard]] std::vector<ColumnInfo> geometry_columns();
[[nodiscard]] Row to_row(const GeometryError& error);

// Length of the diagonal of the bounding box, in units of the mesh.
[[nodiscard]] double diagonal_of(const RawMesh& mesh);

// Both directions in model units: details that commands print beside the row.
[[nodiscard]] Json to_json(const DirectedDistance& distance);

}  // namespace lodestone
