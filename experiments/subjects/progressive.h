// The subject `progressive`: a mesh file in, a progressive mesh as a file out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/progressive/progressive_file.h"
#include "experiments/subjects/row.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct ProgressiveJob {
  std::string input, output;
  ReadConfig reading;
  bool normals = true;  // of the input, if the output keeps them; they make every edge a seam where faces are shaded flat
  std::optional<progressive::MetricKind> metric;  // none: fitting_metric()
  ProgressiveConfig config;                       // but for the metric
  ProgressiveFileConfig file;
  int texture_quality = 0;         // from 1 to 100: of core/texture/recompress.h; 0: textures remain as they are
  std::uint32_t check_levels = 0;  // number of levels whose cracks are counted
  // Called with what begins; may throw.
  std::function<void(const std::string& phase)> on_phase = [](const std::string&) {};
};

struct ProgressiveResult {
  ProgressiveMesh mesh;
  progressive::MetricKind metric = progressive::MetricKind::quadric;
  ProgressiveReport report;
  StageTime time;                           // of making it, without files
  std::optional<ProgressiveFileSize> size;  // of the file, if there is one
  std::optional<std::size_t> residual_edges;
  Repairs repairs;
  std::vector<std::string> warnings;
  std::uint64_t peak_bytes = 0;
};

// Throws what reading, collapsing and writing throw.
[[nodiscard]] ProgressiveResult run(const ProgressiveJob& job, Scheduler& scheduler);

[[nodiscard]] std::vector<ColumnInfo> progressive_columns();
[[nodiscard]] Row to_row(const ProgressiveResult& result);

}  // namespace lodestone
