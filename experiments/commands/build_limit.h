// `lodestone build` within a limit of memory: its options, and what it says of them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "parallel/out_of_core/build_model.h"

namespace lodestone {

struct LimitOptions {
  std::uint64_t memory_limit = 0;  // bytes; 0: none
  std::string scratch;
  bool resume = false;
};

// Adds --memory-limit, --scratch and --resume.
void add_limit_options(CLI::App& command, LimitOptions& options);

// Says on standard output where temporary files go and how large they become.
void print_scratch(const ModelConfig& config, const ModelNeed& need);
[[nodiscard]] nlohmann::json scratch_results(const ModelConfig& config, const ModelNeed& need,
                                             const ModelResult& result);

}  // namespace lodestone
