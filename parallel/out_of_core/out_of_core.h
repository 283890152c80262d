// Building a hierarchy larger than memory: from a mesh file to a .lode file, byte for byte what build_hierarchy and
// save_lode make of it.
//
// The file is read in pieces and its triangles spilled to disk by cells (parallel/out_of_core/spill.h); blocks take their cells
// from there and leave what they make there (parallel/out_of_core/stored_blocks.h). In memory stay 16 bytes per vertex of the
// finest level, what is known of shared vertices, and a block per worker: docs/decisions/0010.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "parallel/build/build.h"
#include "parallel/out_of_core/mesh_stream.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct OutOfCoreConfig {
  BuildConfig build;
  Lattice lattice = {};  // none, one, or Lattice::automatic
  LodeForm form = LodeForm::plain;
  std::uint64_t memory_limit = 0;  // bytes that may be resident at a time, all of the process; at least the need below
  std::filesystem::path scratch;   // folder for temporary files; empty: that of the output
  // Temporary files have names, stay when the build is interrupted or fails, and are taken up where they were left.
  // Otherwise they have none, and are gone however the build ends.
  bool resume = false;
  std::string program;  // version of the program: builds of another one are not continued
  // Called as BuildConfig::progress is, which is not: what is under way, and the share of it that is done.
  std::function<void(const std::string& step, double share)> progress;
  std::uint64_t part_triangles = 0;  // sorted in memory at a time; 0: as the limit allows
};

struct OutOfCoreNeed {
  std::uint64_t memory_bytes = 0;   // the least limit
  std::uint64_t scratch_bytes = 0;  // temporary files, about
};
// Of a mesh with so many vertices and triangles, before anything else is known of it.
[[nodiscard]] OutOfCoreNeed out_of_core_need(std::uint64_t vertices, std::uint64_t triangles,
                                             const OutOfCoreConfig& config, int workers);

// What loading the same mesh and building it in memory takes at most, about.
[[nodiscard]] std::uint64_t in_core_bytes(std::uint64_t vertices, std::uint64_t triangles);

// Where temporary files with names are: DIR/NAME.scratch for an output NAME.
[[nodiscard]] std::filesystem::path scratch_folder(const OutOfCoreConfig& config, const std::filesystem::path& output);

struct OutOfCoreResult {
  Hierarchy tables;  // without payloads
  std::uint64_t file_bytes = 0, scratch_bytes = 0;
  std::uint64_t blocks = 0, blocks_resumed = 0;  // resumed: done by an earlier, interrupted build
  // Stages: clean, spill, shared, hierarchy, write. The total is that of spill, shared and hierarchy, temporary files
  // included, which cannot be told apart: from a stream that is clean to packed levels, as build_hierarchy has it.
  BuildReport report;
};

// Throws ResourceError naming the need when the limit is too small, FileError when a disk is full, what clean_stream
// and build_hierarchy throw, UnsupportedError for BuildConfig::refine, InputError when there is something to resume,
// but of another input or other parameters.
OutOfCoreResult build_out_of_core(const MeshStream& stream, const std::filesystem::path& output,
                                  const OutOfCoreConfig& config, Scheduler& scheduler);

}  // namespace lodestone
