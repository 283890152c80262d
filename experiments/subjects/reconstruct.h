// The subject `reconstruct`: LOD meshes from rendered position maps.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "experiments/metrics/geometry/geometry_error.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/map_files.h"
#include "render/reconstruct/reconstruct.h"

namespace lodestone {

[[nodiscard]] MergeKind merge_kind(const std::string& name);        // throws InputError listing the known names
[[nodiscard]] Projection projection_kind(const std::string& name);  // likewise

// One reconstructed mesh.
struct ReconstructResult {
  std::string file;
  std::vector<std::string> warnings;  // what the format of the file loses
  double resolution = 0;              // pixels along the longest side
  double scale = 1;                   // of normalised units, in units of the model
  std::uint64_t input_triangles = 0;
  std::uint64_t triangles = 0, vertices = 0, wedges = 0;
  ReconstructReport report;
  MeshQuality quality;
  StageTime time;  // from the mesh, or from maps, to the new mesh
  std::uint64_t peak_bytes = 0;
  std::optional<GeometryError> error;       // against the input
  std::optional<SurfaceCoverage> coverage;  // of all that any direction sees from outside, by samples a spacing away
  std::optional<SurfaceCoverage> seen;      // of what pictures from all directions show, likewise
};

struct ReconstructJob {
  std::string input;  // a mesh, or position maps
  std::string output;
  ReadConfig reading;
  ReconstructConfig config;
  double map_resolution = 0;    // for maps, instead of their own; 0: not given
  double distance = 0;          // instead of the resolution: seen from so far, in model units; 0: not given
  std::uint64_t triangles = 0;  // instead of the resolution: about so many in the first mesh; 0: not given
  int levels = 1;               // meshes, each at half the resolution of the one before
  std::string maps;             // folder for the maps of the first mesh; empty: none
  MapFormat map_format = MapFormat::exr;
  bool measure = false;                                                                // error and coverage
  std::function<void(const std::string& phase)> on_phase = [](const std::string&) {};  // may throw
  std::function<void(const ReconstructResult&)> on_level = [](const ReconstructResult&) {};
};

struct ReconstructResults {
  std::vector<ReconstructResult> levels;
  std::uint64_t input_triangles = 0;  // 0: not known, from maps
  Up up;
  Repairs repairs;
  StageTime read;
};

// The file of a level: "out.ply" is "out.2.ply" for level 2.
[[nodiscard]] std::string level_file(const std::string& output, int level);

// Throws InputError when nothing is seen, or for position maps with options that need the mesh.
[[nodiscard]] ReconstructResults run(const ReconstructJob& job, Scheduler& scheduler);

// The parts of it that an experiment times on its own.
[[nodiscard]] ReconstructResult result_of(const Reconstruction& made, const Transform& transform);
void measure(ReconstructResult& result, const Reconstruction& made, const IndexedMesh& input, Scheduler& scheduler);

[[nodiscard]] std::vector<ColumnInfo> reconstruct_columns();
[[nodiscard]] Row to_row(const ReconstructResult& result);

}  // namespace lodestone
