// The subject `build`: a mesh file in, a hierarchy as a .lode file out, in memory or, beyond a limit, on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "experiments/subjects/row.h"
#include "parallel/hierarchy/build.h"
#include "parallel/out_of_core/build_model.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "parallel/scheduler/trace.h"

namespace lodestone {

// Temporary files of a build out of core.
struct ScratchUse {
  std::string folder;
  bool kept = false;                 // until the build is done
  std::uint64_t expected_bytes = 0;  // before the build
  std::uint64_t bytes = 0, blocks = 0, blocks_resumed = 0;
};

struct BuildJob {
  std::vector<std::filesystem::path> inputs;  // one mesh in their order
  std::filesystem::path output;
  ReadConfig reading;
  BuildConfig build;  // its cancel and progress are those of the whole job
  Lattice lattice;
  LodeForm form = LodeForm::plain;
  bool measure_errors = false;     // instead of estimating them while building
  bool texture_levels = false;     // copies of the textures for coarser levels
  std::uint64_t memory_limit = 0;  // bytes that may be resident; 0: no limit
  std::filesystem::path scratch;   // folder for temporary files; empty: that of the output
  bool resume = false;             // temporary files are kept and continued from
  std::shared_ptr<Trace> trace;    // of the scheduler; null: none
  // Called with what begins, and with the triangles that it has to do where that is known.
  std::function<void(const std::string& phase, double triangles)> on_phase = [](const std::string&, double) {};
  // Called before temporary files are written.
  std::function<void(const ScratchUse&)> on_scratch = [](const ScratchUse&) {};
};

struct BuildResult {
  Hierarchy hierarchy;  // without payloads if built out of core
  BuildReport report;
  std::map<std::string, StageTime> stages;
  StageTime total;  // from file to file
  std::uint64_t file_bytes = 0, peak_bytes = 0;
  std::optional<ScratchUse> scratch;  // of a build out of core
  std::optional<TraceSummary> use;    // of the workers, while building
  AttributeCounts attributes;
  std::vector<std::string> warnings;
  std::optional<MeasureReport> measured;  // if the errors are
};

// Throws ResourceError for a file that needs more than the limit and can only be read as a whole, InputError for
// measure_errors or refinement beyond the limit, and what reading, building and writing throw.
[[nodiscard]] BuildResult run(const BuildJob& job, Scheduler& scheduler);

[[nodiscard]] std::vector<ColumnInfo> build_columns();
[[nodiscard]] Row to_row(const BuildResult& result);

// Counts of attributes, and figures by level: details that commands print beside the row.
[[nodiscard]] Json to_json(const AttributeCounts& counts);
[[nodiscard]] Json level_table(const Hierarchy& hierarchy);

}  // namespace lodestone
