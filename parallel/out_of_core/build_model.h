// From a mesh file to a .lode file: in memory, or on disk where the mesh does not fit into a limit of memory. Both give
// the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

class MeshStream;  // parallel/mesh/mesh_stream.h

// Mesh files, which are one mesh in their order, and how they are read.
struct ModelSource {
  std::vector<std::filesystem::path> files;
  ReadConfig reading{};
  std::shared_ptr<const MeshStream> stream{};  // builds on disk from pieces of the files; nullptr: in memory
  std::uint64_t in_core_bytes = 0;  // with a stream: the limit from which on it is built in memory; 0: unknown
};

// Chooses between memory and disk by a limit in bytes; 0: no limit. At least one file; `workers` build later. Throws
// ResourceError for files that exceed the limit and can only be read as a whole, and what open_mesh_stream and
// join_streams throw.
[[nodiscard]] ModelSource open_model_source(std::vector<std::filesystem::path> files, const ReadConfig& reading,
                                            std::uint64_t memory_limit, int workers);

struct ModelProgress {
  std::string step;             // what is under way
  double share = 0;             // of the step that is done, in [0, 1]
  std::uint64_t triangles = 0;  // that the step works through; 0: unknown
};

struct ModelConfig {
  BuildConfig build{};             // its progress is not called
  std::filesystem::path output{};  // the .lode file
  Lattice lattice{};               // none, one, or Lattice::automatic
  LodeForm form = LodeForm::plain;
  bool measure_errors = false;  // instead of estimates (parallel/hierarchy/measure_errors.h); in memory only
  bool texture_copies = false;  // for coarser levels (parallel/hierarchy/texture_levels.h)
  // Bytes that the process may have resident; 0: no limit, in memory only.
  std::uint64_t memory_limit = 0;
  // On disk: folder for temporary files; empty: that of the output.
  std::filesystem::path scratch{};
  // On disk: temporary files have names, are kept when the build is interrupted or fails, and are continued from.
  // Otherwise they have no names and vanish however the build ends.
  bool resume = false;
  std::string program{};             // version of the program: builds of another one are not continued
  std::uint64_t part_triangles = 0;  // on disk: triangles sorted in memory at a time; 0: as the limit allows
  // Called at the start of each step by the calling thread, then now and then from any thread but one at a time.
  std::function<void(const ModelProgress&)> progress{};
};

// Needs of a build on disk.
struct ModelNeed {
  std::uint64_t memory_bytes = 0;   // the smallest possible limit
  std::uint64_t scratch_bytes = 0;  // temporary files, approximately
};
// For a mesh with so many vertices and triangles, before anything else is known about it.
[[nodiscard]] ModelNeed model_need(const MeshStream& stream, const ModelConfig& config, int workers);

// Folder of the temporary files with names: DIR/NAME.scratch for an output NAME.
[[nodiscard]] std::filesystem::path scratch_folder(const std::filesystem::path& output,
                                                   const std::filesystem::path& scratch);

// Numbers of values in the mesh file.
struct AttributeCounts {
  std::size_t wedges = 0, normals = 0, colours = 0, texture_coordinates = 0, materials = 0, textures = 0;
};

struct ModelResult {
  Hierarchy hierarchy;  // built on disk: its tables, without payloads
  std::uint64_t file_bytes = 0, scratch_bytes = 0;
  std::uint64_t blocks = 0, blocks_resumed = 0;  // on disk; resumed: done by an earlier, interrupted build
  AttributeCounts attributes;
  std::vector<std::string> warnings;
  // Stages in memory: read, weld, those of build_hierarchy, build (their total), measure, textures, write. On disk:
  // clean, spill, shared, hierarchy, write. The total is from a clean mesh to packed levels; on disk that is spill,
  // shared and hierarchy with their temporary files.
  BuildReport report;
  std::optional<MeasureReport> measured;  // if the errors are
};

// Builds and writes the hierarchy. Throws what load_mesh, prepare_mesh, build_hierarchy and save_lode throw;
// ResourceError with the need when the limit is too small, FileError when a disk is full; on disk UnsupportedError for
// BuildConfig::refine and measure_errors, and InputError for temporary files of another input or other parameters.
[[nodiscard]] ModelResult build_model(const ModelSource& source, const ModelConfig& config, Scheduler& scheduler);
// The same of a mesh in memory, whatever the limit, and written only if config.output is given. `name` stands for the
// file in messages.
[[nodiscard]] ModelResult build_model(RawMesh&& mesh, const std::string& name, const ModelConfig& config,
                                      Scheduler& scheduler);

}  // namespace lodestone
