// The subject `spherical`: a mesh file in, one mesh over the sphere with octahedral textures as a file out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/progressive/progressive_file.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/scheduler.h"
#include "parallel/spherical/make_spherical.h"
#include "parallel/spherical/tangent_maps.h"

namespace lodestone {

struct SphericalJob {
  std::string input, output;
  ReadConfig reading;
  SphericalConfig config;
  bool compress = false;  // by EXT_meshopt_compression
};

struct SphericalResult {
  ProgressiveMesh mesh;
  SphericalReport report;
  TangentMapReport tangent;  // of a .glb
  StageTime time;            // of making it, without files
  ProgressiveFileSize size;
  std::uint64_t input_triangles = 0;
  Repairs repairs;
  std::vector<std::string> warnings;
  std::uint64_t peak_bytes = 0;
};

// Throws what reading, mapping and writing throw.
[[nodiscard]] SphericalResult run(const SphericalJob& job, Scheduler& scheduler);

[[nodiscard]] std::vector<ColumnInfo> spherical_columns();
[[nodiscard]] Row to_row(const SphericalResult& result);

}  // namespace lodestone
