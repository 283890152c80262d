#include "parallel/distributed/build_distributed.h"

#include <optional>
#include <utility>

#include "core/base/error.h"
#include "parallel/distributed/distributed_clean.h"
#include "parallel/distributed/distributed_wedges.h"
#include "parallel/distributed/rank_blocks.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/distributed/rank_save.h"
#include "parallel/distributed/route_triangles.h"
#include "parallel/hierarchy/build_blocks.h"
#include "parallel/hierarchy/texture_levels.h"

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
  RankInput input;
  std::optional<WedgeSlices> wedges;
  CleanSlices clean = stages.run("reading", [&] {
    ranks.begin("reading");
    input = open(ranks, scheduler);
    check(*input.stream);
    CleanSlices cleaned = distributed_clean(input, config.lattice, ranks, scheduler);
    if (!input.surface) return cleaned;
    head.materials = std::move(input.surface->materials);
    head.textures = std::move(input.surface->textures);
    wedges = weld_wedges(std::move(*input.surface), *input.stream, cleaned, ranks, scheduler);
    input.stream = std::move(wedges->triangles);
    head.attributes = wedges->attributes();
    return cleaned;
  });
  const std::string name = input.stream->name();
  result.warnings = std::move(input.warnings);
  head.transform = clean.transform;
  head.provenance.repairs = clean.repairs;
  head.provenance.input_triangles = clean.triangles_left;
  describe_config(config.build, head);
  head.provenance.input_vertices = clean.vertices_left.total();

  auto [choice, routed] = stages.run("sorting", [&] {
    FinestChoice chosen = choose_cells(*input.stream, clean, config.build, ranks);
    RoutedMesh mesh = route_triangles(*input.stream, std::move(clean), chosen, ranks);
    input.stream.reset();
    if (wedges) attach_wedges(*std::exchange(wedges, {}), mesh, ranks);
    return std::pair(std::move(chosen), std::move(mesh));
  });
  RankFinest finest = stages.run("sharing", [&] {
    ranks.begin("sharing");
    RankFinest made = make_rank_finest(std::move(routed), choice.grid, config.build.sigma0, ranks, scheduler);
    head.provenance.fingerprint = ranks.sum(made.fingerprint);
    return made;
  });
  const std::vector<CellPart> levels = stages.run("building", [&] {
    return build_rank_levels(std::move(finest.part), choice.level,
                             {config.build, choice.owners, head.transform.lattice, head.attributes}, ranks, scheduler);
  });
  stages.report.triangles = finest.triangles.size();
  for (const CellPart& part : levels) stages.report.cells += part.codes.size();
  result.file_bytes = stages.run("writing", [&] {
    return save_ranks(
        levels, head, config.output,
        [&] {
          if (config.texture_copies) copy_textures(name, result, ranks, scheduler);
          result.ranks = stages.gather();
        },
        ranks, scheduler);
  });
  result.ranks[static_cast<std::size_t>(ranks.rank())] = stages.report;
  return result;
}

}  // namespace lodestone
