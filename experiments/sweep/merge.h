// Shards of a sweep that ran on machines without a common file system, brought together.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace lodestone {

struct SweepMergeConfig {
  std::vector<std::string> from;
  std::filesystem::path to;
  bool dry_run = false;  // counts, and writes nothing
};

// Numbers of repetitions after merging.
struct MergeResult {
  std::string name;       // of the sweep
  std::size_t all = 0;    // that the sweep has
  std::size_t done = 0;   // with rows
  std::size_t taken = 0;  // with rows or a fault, from the others
  std::size_t failed = 0;
  std::size_t missing = 0;  // with neither
};

// Copies what `to` lacks of finished repetitions from the other folders, which stay as they are; what is in `to` stays,
// too. All must hold the same sweep, run by the same program on the same data. Throws InputError, FileError.
[[nodiscard]] MergeResult merge_sweeps(const SweepMergeConfig& config);

}  // namespace lodestone
