#include "parallel/out_of_core/out_of_core.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/base/byte_size.h"
#include "core/base/error.h"
#include "core/files/temporaries.h"
#include "core/mesh/precision.h"
#include "parallel/hierarchy/build_blocks.h"
#include "parallel/hierarchy/level_table.h"
#include "parallel/hierarchy/partition.h"
#include "parallel/mesh/vertex_sharing.h"
#include "parallel/out_of_core/out_of_core_state.h"
#include "parallel/out_of_core/spilled_finest.h"
#include "parallel/out_of_core/stored_blocks.h"
#include "parallel/out_of_core/stored_source.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {
namespace {

constexpr std::uint64_t process_bytes = 24 * mebibyte;       // program, libraries, what the allocator keeps
constexpr std::uint64_t worker_bytes = 6 * mebibyte;         // pieces of the stream and of the output
constexpr std::uint64_t most_part = std::uint64_t{1} << 24;  // triangles
constexpr std::uint64_t most_parts = 64;
constexpr std::uint64_t cell_bytes = 1000 + 40 * most_parts;  // of tables; runs of all parts, if the input is shuffled

// Minimum number of triangles that are sorted at a time: smaller parts give more runs.
std::uint64_t least_part(std::uint64_t triangles) {
  return std::min(triangles, std::max(std::uint64_t{1} << 18, triangles / most_parts));
}

[[noreturn]] void fail_too_small(const MeshStream& stream, const std::string& what, std::uint64_t need,
                                 const std::string& remedy) {
  throw ResourceError(
      describe(stream.name(), "", what + " " + needed_mebibytes(need) + " of memory",
               "give --memory-limit " + std::to_string((need + mebibyte - 1) / mebibyte) + "MiB" + remedy));
}

// Divides the limit among the steps.
class Memory {
 public:
  Memory(const MeshStream& stream, const ModelConfig& config, int workers)
      : stream_(stream),
        config_(config),
        workers_(static_cast<std::uint64_t>(workers)),
        fixed_(process_bytes + workers_ * worker_bytes + stream.triangle_count() / 8) {}

  // For searching equal vertices and triangles.
  [[nodiscard]] std::size_t cleaning() const { return left(17 * stream_.vertex_count()); }

  // Triangles that are sorted at a time.
  [[nodiscard]] std::uint64_t part(const CleanStream& clean) const {
    if (config_.part_triangles > 0) return config_.part_triangles;
    const std::uint64_t vertices = vertex_bytes(clean.positions) + 4 * clean.numbers.size();
    const std::uint64_t least = least_part(clean.triangles);
    return std::clamp(left(vertices) / 2 / sizeof(Triangle), least, std::max(least, most_part));
  }

  // Blocks at a time.
  [[nodiscard]] std::size_t lanes(const SpilledMesh& mesh, const BlockPlan& plan) const {
    const std::uint64_t largest_block = StoredBlocks::largest_block(plan, mesh.cells);
    std::uint64_t cells = 0;
    for (const LevelCells& level : plan.levels) cells += level.codes.size();
    const std::uint64_t vertices =
        vertex_bytes(mesh.vertices.positions) + cells * 1000 + mesh.cells.runs.size() * sizeof(Run);
    const std::uint64_t shared = mesh.vertices.shared * SharedVertices::bytes_per_vertex;
    const std::uint64_t lane = largest_block * StoredBlocks::bytes_per_triangle;
    const std::uint64_t need =
        fixed_ + vertices + std::max(mesh.vertices.shared * SharedVertices::peak_bytes_per_vertex, shared + lane);
    if (need > config_.memory_limit)
      fail_too_small(stream_, "its cells and blocks need", need, " or a smaller --cell-triangles");
    return std::clamp<std::uint64_t>(left(vertices + shared) / std::max<std::uint64_t>(lane, 1), 1, workers_);
  }

 private:
  // Positions and a word for each vertex.
  [[nodiscard]] static std::uint64_t vertex_bytes(const std::vector<Vec3f>& positions) {
    return sizeof(Vec3f) * positions.capacity() + sizeof(std::uint32_t) * positions.size();
  }
  [[nodiscard]] std::uint64_t left(std::uint64_t taken) const {
    return config_.memory_limit > fixed_ + taken ? config_.memory_limit - fixed_ - taken : 0;
  }
  const MeshStream& stream_;
  const ModelConfig& config_;
  std::uint64_t workers_, fixed_;
};

void check(const MeshStream& stream, const ModelConfig& config, int workers) {
  check_config(config.build);
  if (config.build.refine) throw UnsupportedError("splitting long edges needs the whole mesh in memory");
  if (config.measure_errors) throw UnsupportedError("measuring errors needs the whole hierarchy in memory");
  const ModelNeed need = model_need(stream, config, workers);
  if (config.memory_limit < need.memory_bytes)
    fail_too_small(stream, "building out of core needs", need.memory_bytes, "");
  const std::filesystem::path folder = scratch_folder(config.output, config.scratch).parent_path();
  const std::uint64_t room = free_bytes(folder.empty() ? "." : folder);
  if (!config.resume && room < need.scratch_bytes)
    throw FileError(describe(folder.empty() ? "." : folder.string(), "",
                             "temporary files need about " + needed_mebibytes(need.scratch_bytes) + ", and " +
                                 available_mebibytes(room) + " are free",
                             "free some space there, or put them on another disk (--scratch)"));
}

// The cells of the triangles that choose_finest_level looks at.
int choose_level(const MeshStream& stream, const CleanStream& clean, std::uint32_t cell_triangles) {
  const std::uint64_t stride = level_sample_stride(clean.triangles);
  std::vector<CellCode> sample;
  std::uint64_t left = 0;  // triangles that are left, so far
  for (std::uint64_t t = 0; t < stream.triangle_count(); ++t) {
    if (clean.dropped[t] || left++ % stride != 0) continue;
    const auto v = clean.read(stream, t, 1).front().v;
    const Vec3f centre = barycentre(clean.positions[v[0]], clean.positions[v[1]], clean.positions[v[2]]);
    sample.push_back(CellCode::from(cell_of(centre, max_level)));
  }
  return finest_level_of(sample, clean.triangles, cell_triangles);
}

// Names, times and progress of the steps.
class Steps {
 public:
  Steps(const MeshStream& stream, const ModelConfig& config, Scheduler& scheduler, ModelResult& result)
      : triangles_(stream.triangle_count()), config_(config), scheduler_(scheduler), result_(result) {}

  // `stage` for the report and traces, `label` for people.
  void begin(const char* stage, const char* label) {
    end();
    stage_ = stage;
    label_ = label;
    clock_ = CpuClock();
    scheduler_.name_work(stage);
    share(0);
  }
  void end() {
    if (stage_) result_.report.stages[stage_] = clock_.elapsed();
    stage_ = nullptr;
  }
  // Done of the step, in [0, 1]. From any thread.
  void share(double done) {
    if (!config_.progress) return;
    const std::unique_lock lock(reporting_, std::try_to_lock);
    if (lock) config_.progress({label_, std::min(done, 1.0), triangles_});
  }

 private:
  std::uint64_t triangles_;
  const ModelConfig& config_;
  Scheduler& scheduler_;
  ModelResult& result_;
  const char *stage_ = nullptr, *label_ = "";
  CpuClock clock_;
  std::mutex reporting_;
};

double ratio(std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); }

// The steps of the recipe in build_out_of_core.
class OutOfCoreBuild {
 public:
  OutOfCoreBuild(const MeshStream& stream, const ModelConfig& config, Scheduler& scheduler)
      : stream_(stream),
        config_(config),
        grids_(grids_of(config.build)),
        scheduler_(scheduler),
        memory_(stream, config, scheduler.workers()),
        files_(stream, config),
        steps_(stream, config, scheduler, result_) {}

  void spill() {
    if (files_.has_spilled()) {
      steps_.begin("resume", "resuming");
      mesh_ = files_.take_spilled(scheduler_);
      return;
    }
    steps_.begin("clean", "reading");
    CleanStream clean = clean_stream(stream_, config_.lattice, memory_.cleaning(), scheduler_,
                                     [&](double share) { steps_.share(share); });
    if (clean.positions.size() >= FinestVertices::shared_flag)
      throw ResourceError("the mesh has more than 2^31 vertices; vertex ids have 32 bits");
    if (const auto crowded = find_crowded(clean.positions, clean.transform))
      result_.warnings.push_back(stream_.name() + ": " + describe(*crowded));
    const BuildConfig& build = config_.build;
    mesh_.level = build.finest_level < 0 ? grids_.finest_level(choose_level(stream_, clean, build.cell_triangles))
                                         : build.finest_level;

    steps_.begin("spill", "sorting");
    mesh_.vertices.sharing.assign(clean.positions.size(), unowned);
    mesh_.cells = spill_triangles(stream_, clean,
                                  {grids_.of(mesh_.level), memory_.part(clean),
                                   [&](std::uint64_t done) { steps_.share(ratio(done, stream_.triangle_count())); }},
                                  mesh_.vertices.sharing, files_.triangles(), scheduler_);
    mesh_.triangles = clean.triangles;
    mesh_.transform = clean.transform;
    mesh_.repairs = clean.repairs;
    mesh_.vertices.positions = std::move(clean.positions);
    mesh_.vertices.shared = number_shared(mesh_.vertices.sharing, scheduler_);
    files_.record_spilled(mesh_);
  }

  void build() {
    plan_ = plan_blocks(mesh_.cells.codes, mesh_.level, grids_);
    const std::size_t lanes = memory_.lanes(mesh_, plan_);
    steps_.begin("shared", "sharing");
    const Lattice lattice = mesh_.transform.lattice;
    const FileSource triangles(files_.triangles());
    SpilledFinest finest(mesh_.cells, triangles, mesh_.vertices,
                         {grids_.of(mesh_.level), config_.build.sigma0, lattice});
    finest.describe_shared(scheduler_, [&](std::uint64_t done) { steps_.share(ratio(done, mesh_.triangles)); });

    steps_.begin("hierarchy", "building");
    CellStore store(files_.cells(), {});
    StoredBlocks blocks(plan_, mesh_.cells, finest, store, lanes);
    if (files_.records()) blocks.on_record([&](std::span<const std::byte> record) { files_.record_block(record); });
    for (const std::vector<std::byte>& record : files_.block_records())
      result_.blocks_resumed += blocks.take_record(record);
    result_.blocks = plan_.blocks.size();
    BuildConfig build = config_.build;
    build.progress = [&](double share) { steps_.share(share); };
    build_blocks({plan_, blocks.in_memory(), blocks, {}, lattice, mesh_.triangles, lanes}, build, scheduler_);
    if (plan_.blocks.empty()) blocks.store_root();
    stored_.cells = std::move(blocks).stored();
  }

  void save() {
    steps_.begin("write", "writing");
    vertices_ = mesh_.vertices.positions.size();
    std::vector<Vec3f>().swap(mesh_.vertices.positions);
    std::vector<std::uint32_t>().swap(mesh_.vertices.sharing);
    fill_tables();
    const CellStore store(files_.cells(), {});
    using enum StoredSource::Order;
    StoredSource source(stored_, store, config_.build.order_cells ? for_compression : as_stored, scheduler_);
    result_.file_bytes = save_lode(source, config_.output, scheduler_, config_.form,
                                   [&](std::size_t cells) { steps_.share(ratio(cells, stored_.tables.cells.size())); });
    steps_.end();
    result_.scratch_bytes = files_.bytes();
    files_.remove();
  }

  [[nodiscard]] ModelResult result() {
    for (const char* stage : {"spill", "shared", "hierarchy"}) {  // what build_hierarchy does, too
      const auto time = result_.report.stages.find(stage);
      if (time == result_.report.stages.end()) continue;  // done by the build that is continued
      result_.report.total.seconds += time->second.seconds;
      result_.report.total.cpu_seconds += time->second.cpu_seconds;
    }
    result_.hierarchy = std::move(stored_.tables);
    return std::move(result_);
  }

 private:
  void fill_tables() {
    Hierarchy& out = stored_.tables;
    describe_config(config_.build, out);
    out.transform = mesh_.transform;
    out.provenance.input_vertices = vertices_;
    out.provenance.input_triangles = mesh_.triangles;
    out.provenance.repairs = mesh_.repairs;
    out.provenance.fingerprint = mesh_.cells.fingerprint;
    for (std::size_t l = 0; l < plan_.levels.size(); ++l)
      append_level(
          plan_, l,
          [&](CellRank rank) {
            const StoredCell& cell = stored_.cells[l][rank];
            return LevelEntry{&cell, cell.vertices, cell.triangles};
          },
          out);
  }

  const MeshStream& stream_;
  const ModelConfig& config_;
  LevelGrids grids_;
  Scheduler& scheduler_;
  ModelResult result_;
  Memory memory_;
  OutOfCoreFiles files_;
  Steps steps_;
  SpilledMesh mesh_;
  BlockPlan plan_;
  StoredHierarchy stored_;
  std::uint64_t vertices_ = 0;
};

}  // namespace

ModelNeed model_need(const MeshStream& stream, const ModelConfig& config, int workers) {
  const std::uint64_t vertices = stream.vertex_count(), triangles = stream.triangle_count();
  // Cells are about square pieces of a surface: this share of their vertices is on their borders, with room for more
  // crooked ones.
  const double cell = config.build.finest_level < 0 ? std::max(config.build.cell_triangles, 2u) : 4000;
  const double border = std::min(1.0, 4 / std::sqrt(cell / 2));
  const auto shared = static_cast<std::uint64_t>(border * static_cast<double>(vertices));
  const double stored = (config.build.half_levels ? 2.0 : 4.0 / 3) * static_cast<double>(triangles);
  const auto cells = static_cast<std::uint64_t>(stored / cell);
  // A block has 64 cells at most, about 20 of them occupied, and cells have twice the triangles asked for at most.
  const std::uint64_t block = std::min(triangles, static_cast<std::uint64_t>(48 * cell));
  ModelNeed need;
  need.memory_bytes =
      process_bytes + static_cast<std::uint64_t>(workers) * worker_bytes + triangles / 8 + cells * cell_bytes +
      std::max({20 * vertices + least_part(triangles) * sizeof(Triangle),
                16 * vertices + shared * SharedVertices::peak_bytes_per_vertex,
                16 * vertices + shared * SharedVertices::bytes_per_vertex + block * StoredBlocks::bytes_per_triangle});
  // Triangles once for sorting, then cells: 23 bytes per triangle, and what only blocks know.
  need.scratch_bytes =
      12 * triangles + static_cast<std::uint64_t>(24.75 * stored) + (config.resume ? 12 * vertices : 0);
  return need;
}

ModelResult build_out_of_core(const MeshStream& stream, const ModelConfig& config, Scheduler& scheduler) {
  check(stream, config, scheduler.workers());
  const std::unique_ptr<Scheduler> cancelling = make_watched_scheduler(scheduler, {.cancel = config.build.cancel});
  OutOfCoreBuild build(stream, config, *cancelling);
  if (config.resume) remove_orphans(config.output);  // of the build that is continued
  build.spill();
  build.build();
  build.save();
  return build.result();
}

}  // namespace lodestone
