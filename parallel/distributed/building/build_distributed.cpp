#include "parallel/distributed/building/build_distributed.h"

#include <memory>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/files/temporaries.h"
#include "parallel/distributed/building/stored_levels.h"
#include "parallel/distributed/distributed_clean.h"
#include "parallel/distributed/distributed_wedges.h"
#include "parallel/distributed/rank_blocks.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/distributed/rank_save.h"
#include "parallel/distributed/route_triangles.h"
#include "parallel/hierarchy/build_blocks.h"
#include "parallel/hierarchy/texture_levels.h"
#include "parallel/out_of_core/build_journal.h"
#include "parallel/out_of_core/build_model.h"

namespace lodestone {
namespace {

void check(const DistributedConfig& config) {
  check_config(config.build);
  if (config.build.refine) throw UnsupportedError("splitting long edges needs the whole mesh on one machine");
  if (config.build.order_cells) throw UnsupportedError("compressed files are not written by several ranks");
}

void check(const MeshStream& stream) {
  if (stream.has_attributes())
    throw UnsupportedError(describe(stream.name(), "", "has attributes of vertices, which are not read in slices",
                                    "open it with open_rank_input"));
  if (stream.vertex_count() >= FinestVertices::shared_flag)
    throw ResourceError(describe(stream.name(), "", "has more than 2^31 vertices; vertex ids have 32 bits"));
  if (stream.triangle_count() >= 0xffff'ffffu)
    throw ResourceError(describe(stream.name(), "", "more triangles than 32-bit numbers reach", "split the model"));
}

struct CleanInput {
  RankInput input;
  std::optional<RankMemory> memory;
  std::unique_ptr<KeptBlocks> kept;  // if the build is to be continued
  CleanSlices clean;
  std::optional<WedgeSlices> wedges;  // of a mesh with attributes; those of `input` are here then
};

RankMemory memory_of(const RankInput& input, const DistributedConfig& config, Ranks& ranks, Scheduler& scheduler) {
  RankLimit limit = config.limit;
  if (limit.scratch.empty()) limit.scratch = config.output.parent_path();
  return {input, limit, config.build, ranks, scheduler.workers()};
}

std::unique_ptr<KeptBlocks> open_kept(const RankInput& input, const DistributedConfig& config, Ranks& ranks) {
  const MeshStream& stream = *input.stream;
  if (ranks.rank() == 0) remove_orphans(config.output);  // of the build that is continued
  // Machines may differ in the times of files.
  const std::uint64_t content = ranks.gather(ranks.rank() == 0 ? stream.identity() : 0).front();
  return std::make_unique<KeptBlocks>(
      scratch_folder(config.output, config.limit.scratch),
      build_identity({content, stream.vertex_count(), stream.triangle_count(), stream.up()}, config.build,
                     config.lattice, config.program),
      ranks);
}

CleanInput read_clean(const OpenInput& open, const DistributedConfig& config, Hierarchy& head, Ranks& ranks,
                      Scheduler& scheduler) {
  CleanInput out;
  auto& [input, memory, kept, clean, wedges] = out;
  ranks.begin("reading");
  input = open(ranks, scheduler);
  check(*input.stream);
  memory = memory_of(input, config, ranks, scheduler);
  if (memory->resumes()) kept = open_kept(input, config, ranks);
  clean = distributed_clean(input, config.lattice, ranks, scheduler, memory->compared_items());
  if (input.surface) {
    head.materials = std::move(input.surface->materials);
    head.textures = std::move(input.surface->textures);
    wedges = weld_wedges(std::move(*input.surface), *input.stream, clean, ranks, scheduler);
    input.stream = std::move(wedges->triangles);
    head.attributes = wedges->attributes();
  }
  head.transform = clean.transform;
  head.provenance.repairs = clean.repairs;
  head.provenance.input_vertices = clean.vertices_left.total();
  head.provenance.input_triangles = clean.triangles_left;
  describe_config(config.build, head);
  return out;
}

// At rank 0, which has all textures.
void copy_textures(const std::string& name, DistributedResult& result, Ranks& ranks, Scheduler& scheduler) {
  ranks.begin("halving textures");
  if (ranks.rank() > 0) return;
  for (const std::string& warning : add_texture_copies(result.tables, scheduler))
    result.warnings.push_back(name + ": " + warning);
}

// Measures the stages of a rank.
class Stages {
 public:
  Stages(const DistributedConfig& config, Ranks& ranks, Scheduler& scheduler)
      : config_(config), ranks_(ranks), scheduler_(scheduler) {}

  template <class Work>
  auto run(const char* label, const Work& work) {
    if (config_.on_stage) config_.on_stage(label);
    scheduler_.name_work(distributed_stages[next_]);
    clock_ = CpuClock();
    before_ = ranks_.traffic();
    auto out = work();
    measure();
    ++next_;
    return out;
  }

  // The reports of all ranks, when their last stage is nearly done.
  [[nodiscard]] std::vector<RankReport> gather() {
    measure();
    std::vector<RankReport> all = ranks_.gather(report);
    if (config_.last_words) config_.last_words();
    return all;
  }

  RankReport report;

 private:
  void measure() { report.stages[next_] = {clock_.elapsed(), ranks_.traffic().since(before_)}; }

  const DistributedConfig& config_;
  Ranks& ranks_;
  Scheduler& scheduler_;
  std::size_t next_ = 0;
  CpuClock clock_;
  Traffic before_;
};

}  // namespace

RankStage RankReport::total() const {
  RankStage sum;
  for (const RankStage& stage : stages) {
    sum.time += stage.time;
    sum.traffic += stage.traffic;
  }
  return sum;
}

DistributedResult build_distributed(const OpenInput& open, const DistributedConfig& config, Ranks& ranks,
                                    Scheduler& scheduler) {
  check(config);
  Stages stages(config, ranks, scheduler);
  DistributedResult result;
  Hierarchy& head = result.tables;
  CleanInput read = stages.run("reading", [&] { return read_clean(open, config, head, ranks, scheduler); });
  RankInput& input = read.input;
  const RankMemory& memory = *read.memory;
  const std::string name = input.stream->name();
  result.warnings = std::move(input.warnings);

  std::unique_ptr<StoredFinest> stored;  // if the rank does not keep its cells in memory
  std::pair sorted = stages.run("sorting", [&] {
    FinestChoice chosen = choose_cells(*input.stream, read.clean, config.build, ranks);
    RoutedMesh mesh;
    if (memory.spills())
      stored = std::make_unique<StoredFinest>(*input.stream, std::move(read.clean), chosen, memory, ranks, scheduler);
    else
      mesh = route_triangles(*input.stream, std::move(read.clean), chosen, ranks);
    input.stream.reset();
    if (read.wedges) attach_wedges(*std::exchange(read.wedges, {}), mesh, ranks);
    return std::pair(std::move(chosen), std::move(mesh));
  });
  const FinestChoice& choice = sorted.first;  // names of their own: clang 14 lets no closure use parts of a binding
  RankFinest finest = stages.run("sharing", [&] {
    ranks.begin("sharing");
    RankFinest made;
    if (stored)
      stored->share(choice, config.build.sigma0, ranks, scheduler);
    else
      made = make_rank_finest(std::move(sorted.second), choice.grid, config.build.sigma0, ranks, scheduler);
    head.provenance.fingerprint = ranks.sum(stored ? stored->cells().fingerprint : made.fingerprint);
    return made;
  });
  stages.report.triangles = stored ? stored->triangles() : finest.triangles.size();
  const std::unique_ptr<RankLevels> levels = stages.run("building", [&]() -> std::unique_ptr<RankLevels> {
    const BlockSetting setting{config.build, choice.owners, head.transform.lattice, head.attributes};
    if (stored)
      return std::make_unique<StoredLevels>(std::move(stored), choice.level, setting,
                                            StoredSetting{memory, read.kept.get()}, ranks, scheduler);
    return std::make_unique<RankLevelsInMemory>(
        build_rank_levels(std::move(finest.part), choice.level, setting, ranks, scheduler));
  });
  for (std::size_t l = 0; l < levels->level_count(); ++l) stages.report.cells += levels->codes(l).size();
  if (read.kept) stages.report.blocks_resumed = read.kept->resumed();
  result.spilled = memory.spills();
  result.file_bytes = stages.run("writing", [&] {
    return save_ranks(
        *levels, head, config.output,
        [&] {
          if (config.texture_copies) copy_textures(name, result, ranks, scheduler);
          result.ranks = stages.gather();
        },
        ranks, scheduler);
  });
  if (read.kept) read.kept->remove();
  result.ranks[static_cast<std::size_t>(ranks.rank())] = stages.report;
  return result;
}

}  // namespace lodestone
