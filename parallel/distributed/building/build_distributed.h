// The .lode file of a mesh, built by all ranks of a job: the same bytes as build_model, from any number of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/distributed/building/rank_memory.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/rank_input.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct DistributedConfig {
  BuildConfig build{};             // not: strategy, refine, order_cells, progress
  std::filesystem::path output{};  // the .lode file, in a folder that all machines share
  Lattice lattice{};               // none, or one
  bool texture_copies = false;     // of textures for coarser levels: rank 0 makes them (texture_levels.h)
  // Cells and triangles that do not fit are put into temporary files without names, which vanish however the build
  // ends: in the folder of the output if no other is given. Those of a mesh with attributes have to fit.
  RankLimit limit{};
  std::string program{};  // version of the program: builds of another one are not continued
  // Called by all ranks at the start of each stage, with its name for people.
  std::function<void(const std::string&)> on_stage{};
  // Called by all ranks when the file is complete but for what rank 0 writes alone, for the caller's own messages:
  // there are no others after it, so that no rank can fail once the file is there.
  std::function<void()> last_words{};
};

// Time and messages of a rank in a stage.
struct RankStage {
  StageTime time;
  Traffic traffic;
};

inline constexpr std::array<const char*, 5> distributed_stages{"clean", "route", "finest", "levels", "write"};

struct RankReport {
  std::uint64_t triangles = 0;       // of the finest level that the rank has
  std::uint64_t cells = 0;           // of all levels
  std::uint64_t blocks_resumed = 0;  // done by an earlier, interrupted build
  std::array<RankStage, distributed_stages.size()> stages{};
  [[nodiscard]] RankStage total() const;
};

struct DistributedResult {
  Hierarchy tables;                   // without payloads: levels and cells at rank 0 alone
  std::uint64_t file_bytes = 0;       // at rank 0
  std::vector<std::string> warnings;  // about the input; of copies of textures at rank 0
  bool spilled = false;               // the cells were kept in temporary files
  std::vector<RankReport> ranks;      // at all ranks; the last stage of the others ends before that of rank 0
};

using OpenInput = std::function<RankInput(Ranks&, Scheduler&)>;

// Called by all ranks, for the same input and with the same configuration. Throws what build_model throws, also for a
// limit; UnsupportedError for options that are not built by ranks and for a stream with attributes, which come as
// RankInput::surface instead. An error of one rank has to reach the others (Transport::fail), or they wait until the
// time-out.
[[nodiscard]] DistributedResult build_distributed(const OpenInput& open, const DistributedConfig& config, Ranks& ranks,
                                                  Scheduler& scheduler);

}  // namespace lodestone
