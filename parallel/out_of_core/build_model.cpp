#include "parallel/out_of_core/build_model.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <type_traits>
#include <utility>

#include "core/base/byte_size.h"
#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/mesh/precision.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/hierarchy/save.h"
#include "parallel/hierarchy/texture_levels.h"
#include "parallel/mesh/joined_stream.h"
#include "parallel/mesh/load.h"
#include "parallel/mesh/mesh_stream.h"
#include "parallel/out_of_core/out_of_core.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

// `how`: about or at least.
[[noreturn]] void fail_beyond(const std::string& input, const std::string& how, std::uint64_t need,
                              std::uint64_t limit) {
  throw ResourceError(describe(
      input, "",
      "needs " + how + " " + needed_mebibytes(need) + " in memory, and the limit is " + available_mebibytes(limit),
      "give it as binary PLY of triangles without attributes or as binary STL, which are built out of core "
      "(--no-attributes leaves those of a PLY out), or --memory-limit " +
          std::to_string((need + mebibyte - 1) / mebibyte) + "MiB"));
}

// Upper bound of the memory while a mesh is loaded and built: a fifth to a quarter more than was measured on models of
// a million triangles and more. Each worker has a block of at most some 61,000 vertices. `reading`: maximum while the
// file is read, where that may be more than what comes after it.
std::uint64_t in_core_bytes(std::uint64_t vertices, std::uint64_t triangles, int workers, std::uint64_t reading = 0) {
  constexpr std::uint64_t process_bytes = 20 * mebibyte, block_bytes = 13 * mebibyte, block_vertex_bytes = 230;
  const std::uint64_t block = std::min(block_bytes, block_vertex_bytes * vertices);
  return process_bytes + static_cast<std::uint64_t>(workers) * block +
         std::max({37 * vertices + 12 * triangles, 24 * vertices + 28 * triangles, reading});
}

// Files that are in memory as a whole while they are read; Draco needs tables of its own, too.
std::uint64_t reading_bytes(std::span<const std::filesystem::path> files, const RawMesh& mesh) {
  const std::uint64_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  if (files.size() > 1) {  // arrays that grow are there twice, and a packed file may be nearly all
    constexpr std::array packed{".drc", ".glb", ".gltf"};
    const bool any_packed = std::ranges::any_of(files, [&](const std::filesystem::path& file) {
      return std::ranges::find(packed, extension_of(file)) != packed.end();
    });
    return std::max(48 * vertices + 24 * triangles, any_packed ? 80 * triangles : 0);
  }
  const std::filesystem::path& path = files.front();
  const std::string extension = extension_of(path);
  const std::uint64_t plain = 24 * vertices + 28 * triangles;
  if (extension == ".gltf") return plain + 12 * vertices + 12 * triangles;
  if (extension != ".glb" && extension != ".drc") return 0;
  std::error_code ignored;
  const std::uintmax_t bytes = std::filesystem::file_size(path, ignored);
  const bool packed = bytes < 12 * triangles;
  return packed ? 80 * triangles : plain + bytes;
}

void check_limit(std::span<const std::filesystem::path> files, const RawMesh& mesh, std::uint64_t limit, int workers) {
  constexpr std::uint64_t wedge_bytes = 48;  // of attributes, while corners become wedges
  std::uint64_t need =
      in_core_bytes(mesh.positions.size(), mesh.triangles.size(), workers, reading_bytes(files, mesh)) +
      wedge_bytes * wedge_count(mesh);
  for (const Texture& texture : mesh.textures) need += 2 * texture.bytes.size();  // in the mesh, and in what is written
  if (limit > 0 && need > limit) fail_beyond(name_of_files(files), "about", need, limit);
}

AttributeCounts count_attributes(const RawMesh& mesh) {
  return {wedge_count(mesh),     mesh.wedges.normal.size(), mesh.wedges.colour.size(),
          mesh.wedges.uv.size(), mesh.materials.size(),     mesh.textures.size()};
}

// The steps in memory.
class InCoreBuild {
 public:
  InCoreBuild(std::string name, const ModelConfig& config, Scheduler& scheduler)
      : name_(std::move(name)), config_(config), scheduler_(scheduler) {}

  ModelResult run(const ModelSource& source) {
    RawMesh raw = step("read", "reading", [&] { return load_meshes(source.files, scheduler_, source.reading); });
    check_limit(source.files, raw, config_.memory_limit, scheduler_.workers());
    return run(std::move(raw));
  }

  ModelResult run(RawMesh&& raw) {
    result_.attributes = count_attributes(raw);
    result_.warnings = std::move(raw.warnings);
    Repairs repairs;
    IndexedMesh mesh = step("weld", "welding",
                            [&] { return prepare_mesh(std::move(raw), repairs, scheduler_, name_, config_.lattice); });
    if (const auto crowded = find_crowded(mesh.positions, mesh.transform))
      result_.warnings.push_back(name_ + ": " + describe(*crowded));
    triangles_ = mesh.triangles.size();
    BuildConfig build = config_.build;
    build.progress = [&](double share) { report(share); };
    BuildReport report;
    Hierarchy& hierarchy = result_.hierarchy;
    hierarchy = step("build", "building", [&] { return build_hierarchy(std::move(mesh), build, scheduler_, &report); });
    triangles_ = 0;
    hierarchy.provenance.repairs = repairs;
    report.stages.merge(result_.report.stages);
    result_.report = std::move(report);
    if (config_.measure_errors)
      result_.measured = step("measure", "measuring", [&] {
        return measure_errors(hierarchy, {.cancel = build.cancel, .progress = build.progress}, scheduler_);
      });
    if (config_.texture_copies) copy_textures();
    if (!config_.output.empty())
      result_.file_bytes =
          step("write", "writing", [&] { return save_lode(hierarchy, config_.output, scheduler_, config_.form); });
    return std::move(result_);
  }

 private:
  // `stage` is the name in the report and in traces, `label` the name for people.
  template <class Work>
  std::invoke_result_t<const Work&> step(const char* stage, const char* label, const Work& work) {
    label_ = label;
    scheduler_.name_work(stage);
    report(0);
    const CpuClock clock;
    auto out = work();
    result_.report.stages[stage] = clock.elapsed();
    return out;
  }

  void report(double share) const {
    if (config_.progress) config_.progress({label_, share, triangles_});
  }

  void copy_textures() {
    for (std::string& warning : step("textures", "halving textures", [&] {
           return add_texture_copies(result_.hierarchy, scheduler_, config_.build.cancel);
         }))
      result_.warnings.push_back(name_ + ": " + warning);
  }

  const std::string name_;  // of the mesh, for messages
  const ModelConfig& config_;
  Scheduler& scheduler_;
  ModelResult result_;
  const char* label_ = "";
  std::uint64_t triangles_ = 0;
};

// All files as one; nullptr if one of them has to be read as a whole.
std::unique_ptr<MeshStream> open_streams(std::span<const std::filesystem::path> files, const ReadConfig& reading) {
  std::vector<std::unique_ptr<MeshStream>> parts;
  for (const std::filesystem::path& file : files) {
    parts.push_back(open_mesh_stream(file, reading));
    if (!parts.back()) return nullptr;
  }
  return join_streams(std::move(parts), name_of_files(files));
}

// A small mesh needs more on disk, for tables and pieces, than in memory: the smaller need is the one to give.
void refuse_small_limit(const ModelSource& source, const ModelConfig& config, int workers) {
  const std::uint64_t on_disk = model_need(*source.stream, config, workers).memory_bytes;
  if (source.in_core_bytes == 0 || source.in_core_bytes >= on_disk || config.memory_limit >= on_disk) return;
  throw ResourceError(
      describe(name_of_files(source.files), "",
               "needs " + needed_mebibytes(source.in_core_bytes) + " of memory, and the limit is " +
                   available_mebibytes(config.memory_limit),
               "give --memory-limit " + std::to_string((source.in_core_bytes + mebibyte - 1) / mebibyte) + "MiB"));
}

}  // namespace

ModelSource open_model_source(std::vector<std::filesystem::path> files, const ReadConfig& reading,
                              std::uint64_t memory_limit, int workers) {
  ModelSource source{std::move(files), reading};
  if (memory_limit == 0) return source;
  if (std::unique_ptr<MeshStream> stream = open_streams(source.files, reading); stream && !stream->has_attributes()) {
    const std::uint64_t need = in_core_bytes(stream->vertex_count(), stream->triangle_count(), workers);
    if (need > memory_limit) source.stream = std::move(stream), source.in_core_bytes = need;
    return source;
  }
  std::uintmax_t bytes = 0;
  for (const std::filesystem::path& file : source.files) {
    std::error_code failed;
    const std::uintmax_t size = std::filesystem::file_size(file, failed);
    if (!failed) bytes += size;
  }
  // No format is larger in the file than in memory.
  if (bytes > memory_limit) fail_beyond(name_of_files(source.files), "at least", bytes, memory_limit);
  return source;
}

std::filesystem::path scratch_folder(const std::filesystem::path& output, const std::filesystem::path& scratch) {
  std::filesystem::path name = output.filename();
  name += ".scratch";
  return (scratch.empty() ? output.parent_path() : scratch) / name;
}

ModelResult build_model(const ModelSource& source, const ModelConfig& config, Scheduler& scheduler) {
  if (!source.stream) return InCoreBuild(name_of_files(source.files), config, scheduler).run(source);
  refuse_small_limit(source, config, scheduler.workers());
  return build_out_of_core(*source.stream, config, scheduler);
}

ModelResult build_model(RawMesh&& mesh, const std::string& name, const ModelConfig& config, Scheduler& scheduler) {
  return InCoreBuild(name, config, scheduler).run(std::move(mesh));
}

}  // namespace lodestone
