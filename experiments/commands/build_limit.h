// `lodestone build` within a limit of memory: its options, and what it says of them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "parallel/out_of_core/build_model.h"

namespace lodestone {

struct LimitOptions {
  std::string memory_limit;  // as given; empty: none
  std::string scratch;
  bool resume = false;
};

// Adds --memory-limit, --scratch and --resume.
void add_limit_options(CLI::App& command, LimitOptions& options);

// "2GiB", "1500MB", "4G" (powers of 1024), "1048576". Throws InputError for anything else.
[[nodiscard]] std::uint64_t parse_size(const std::string& text);

// Says on standard output where temporary files go and how large they become.
void print_scratch(const ModelConfig& config, const ModelNeed& need);
[[nodiscard]] nlohmann::json scratch_results(const ModelConfig& config, const ModelNeed& need,
                                             const ModelResult& result);

}  // namespace lodestone
