// `lodestone build` within a limit of memory: its options, and what it says of them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "parallel/out_of_core/mesh_stream.h"
#include "parallel/out_of_core/out_of_core.h"

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

// The input as a stream when there is a limit and the mesh does not fit into it; nullptr when it is to be built in
// memory. Throws ResourceError for a file that does not fit and can be read as a whole alone.
[[nodiscard]] std::unique_ptr<MeshStream> stream_beyond_limit(const LimitOptions& options, const std::string& input,
                                                              const ReadConfig& reading);
// For a mesh that was read as a whole: throws ResourceError when building it takes more than the limit.
void check_limit(const LimitOptions& options, const std::string& input, const RawMesh& mesh);

// Says on standard output where temporary files go and how large they become.
void print_scratch(const OutOfCoreConfig& config, const OutOfCoreNeed& need, const std::string& output);
[[nodiscard]] nlohmann::json scratch_results(const OutOfCoreConfig& config, const OutOfCoreNeed& need,
                                             const std::string& output, const OutOfCoreResult& result);

}  // namespace lodestone
