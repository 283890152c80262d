#include "parallel/hierarchy/build.h"

#include <algorithm>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/hierarchy/construct/cell_order.h"
#include "core/simplify/simplifiers.h"
#include "parallel/hierarchy/build_blocks.h"
#include "parallel/hierarchy/finest_level.h"
#include "parallel/hierarchy/level_table.h"
#include "parallel/hierarchy/partition.h"
#include "parallel/mesh/refine_mesh.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

// Everything that the blocks work on; becomes the storage of the finished hierarchy.
struct Build {
  std::vector<Triangle> triangles;  // of the finest level
  BlockPlan plan;
  Lattice lattice;                            // on which the vertices lie, if any
  std::vector<std::vector<CellBuild>> cells;  // by level, by rank
  AttributeSet attributes;
};

void check(const IndexedMesh& mesh, const BuildConfig& config) {
  check_config(config);
  if (mesh.triangles.empty()) throw InputError("the mesh has no triangles");
  if (mesh.positions.size() >= FinestVertices::shared_flag)
    throw ResourceError("the mesh has more than 2^31 vertices; vertex ids have 32 bits");
}

// Reorders each cell, then the parents, which name places in another cell. A cell's figures do not depend on the
// order.
void order_cells(Build& build, Scheduler& scheduler) {
  struct Place {
    std::size_t level;
    CellRank rank;
  };
  std::vector<Place> all;
  std::vector<std::vector<std::vector<std::uint32_t>>> moved(build.cells.size());  // by level, by rank: see order_cell
  for (std::size_t l = 0; l < build.cells.size(); ++l) {
    moved[l].resize(build.cells[l].size());
    for (CellRank rank{0}; rank < build.cells[l].size(); ++rank) all.push_back({l, rank});
  }
  std::vector<CellOrderScratch> scratch(static_cast<std::size_t>(scheduler.workers()));
  constexpr std::size_t grain = 16;
  scheduler.for_chunks(all.size(), grain, [&](ChunkRange range) {
    CellOrderScratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t i = range.begin; i < range.end; ++i)
      moved[all[i].level][all[i].rank] = order_cell(build.cells[all[i].level][all[i].rank], s);
  });
  scheduler.for_chunks(all.size(), grain, [&](ChunkRange range) {
    CellOrderScratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const auto [level, rank] = all[i];
      if (level == 0) continue;
      order_parents(build.cells[level][rank], moved[level][rank],
                    moved[level - 1][build.plan.levels[level].parent[rank]], s);
    }
  });
}

// A level's tables, with views of the payloads.
void assemble_level(const Build& build, std::size_t l, Hierarchy& out) {
  const std::vector<CellBuild>& built = build.cells[l];
  append_level(
      build.plan, l,
      [&](CellRank rank) {
        return LevelEntry{&built[rank], built[rank].vertex_count(), built[rank].triangles.size()};
      },
      out);
  for (CellRank rank{0}; rank < built.size(); ++rank)
    view_payload(built[rank], l > 0, out.cells[out.levels[l].id_of(rank)]);
}

// L, asked for or chosen; with splitting, such that it stays within its limit.
int finest_level_of(const IndexedMesh& mesh, const BuildConfig& config) {
  const bool choose = config.finest_level < 0;
  const LevelGrids grids = grids_of(config);
  int finest = choose ? grids.finest_level(choose_finest_level(mesh, config.cell_triangles)) : config.finest_level;
  if (!config.refine) return finest;
  const auto triangles = static_cast<double>(mesh.triangles.size());
  const std::uint64_t most =
      std::max(min_refine_limit, static_cast<std::uint64_t>(std::min(config.refine_limit * triangles, 0x1p62)));
  const auto longest = [&] { return double{config.sigma0} * cell_size(grids.of(finest)); };
  while (choose && finest > 0 && !can_refine(longest(), mesh.transform.lattice)) --finest;
  while (count_refined(mesh, longest(), most) > most) {
    if (!choose || finest == 0)
      throw InputError(describe("", "",
                                "splitting all edges longer than sigma0 h_L makes more than " + std::to_string(most) +
                                    " triangles of " + std::to_string(mesh.triangles.size()),
                                "ask for fewer levels (--levels), or allow more (--refine-limit)"));
    --finest;
  }
  return finest;
}

// The finest level, and empty cells on the others. Releases what only the partition needs.
void partition_finest(IndexedMesh&& mesh, int finest, Build& build, Hierarchy& out, Scheduler& scheduler) {
  Partition partition = partition_mesh(std::move(mesh), out.grids.of(finest), scheduler);
  out.provenance.fingerprint = partition.fingerprint;
  build.plan = plan_blocks(partition.codes, finest, out.grids);
  for (int l = 0; l < finest; ++l)
    build.cells.emplace_back(build.plan.levels[static_cast<std::size_t>(l)].codes.size());
  build.triangles = std::move(partition.triangles);
  build.cells.push_back(make_finest_cells(std::move(partition), out.grids.of(finest), out.sigma0, scheduler));
  // The lattice has moved the input, and the middles of split edges once more.
  const float moved = (out.provenance.refined ? 2 : 1) * build.lattice.error();
  for (CellBuild& cell : build.cells.back()) cell.error = moved;
}

}  // namespace

Strategy strategy_named(std::string_view name) {
  for (const Strategy s : {Strategy::serial, Strategy::levels, Strategy::graph})
    if (name == name_of(s)) return s;
  throw InputError("unknown strategy '" + std::string(name) + "'; " + known_names(name, {"serial", "levels", "graph"}));
}

std::string_view name_of(Strategy strategy) {
  constexpr std::string_view names[] = {"serial", "levels", "graph"};
  return names[static_cast<std::size_t>(strategy)];
}

void check_config(const BuildConfig& config) {
  if (!(config.sigma0 > 0 && config.sigma0 <= 2)) throw InputError("sigma0 must lie in (0, 2]");
  if (config.cell_triangles < 1) throw InputError("a cell must hold at least one triangle");
  if (!(config.refine_limit > 0)) throw InputError("the limit of splitting must be above 0");
  if (config.finest_level > max_level)
    throw InputError("at most " + std::to_string(max_level) + " levels below the root are supported");
  (void)make_simplifier(config.simplifier, placement_of(config));
}

Hierarchy build_hierarchy(IndexedMesh&& mesh, const BuildConfig& config, Scheduler& scheduler, BuildReport* report) {
  check(mesh, config);
  const CpuClock total;
  const auto build = std::make_shared<Build>();
  Hierarchy out;
  out.transform = mesh.transform;
  build->lattice = mesh.transform.lattice;
  describe_config(config, out);
  out.attributes = build->attributes = attributes_of(mesh);
  out.materials = std::move(mesh.wedges.materials);
  out.textures = std::move(mesh.wedges.textures);

  scheduler.name_work("partition");
  const CpuClock refine_clock;
  const int finest = finest_level_of(mesh, config);
  RefineReport refinement;
  if (config.refine) {
    refinement = refine_mesh(mesh, double{config.sigma0} * out.cell_size(finest), scheduler);
    out.provenance.refined = true;
  }
  out.provenance.input_vertices = mesh.positions.size();
  out.provenance.input_triangles = mesh.triangles.size();
  const StageTime refine_time = refine_clock.elapsed();
  const CpuClock partition_clock;
  partition_finest(std::move(mesh), finest, *build, out, scheduler);
  const StageTime partition_time = partition_clock.elapsed();

  const CpuClock hierarchy_clock;
  CellStorage in_memory;
  build_blocks({build->plan, build->cells, in_memory, build->attributes, build->lattice, build->triangles.size(),
                static_cast<std::size_t>(scheduler.workers())},
               config, scheduler);
  const StageTime hierarchy_time = hierarchy_clock.elapsed();
  const CpuClock order_clock;
  if (config.order_cells) order_cells(*build, scheduler);
  const StageTime order_time = order_clock.elapsed();
  for (std::size_t l = 0; l < build->plan.levels.size(); ++l) assemble_level(*build, l, out);
  out.storage = build;

  if (report) {
    if (config.refine) report->stages["refine"] = refine_time;
    report->refinement = refinement;
    report->stages["partition"] = partition_time;
    report->stages["hierarchy"] = hierarchy_time;
    if (config.order_cells) report->stages["order"] = order_time;
    report->total = total.elapsed();
  }
  return out;
}

}  // namespace lodestone
