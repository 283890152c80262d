#include "parallel/build.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>

#include "core/base/error.h"
#include "core/hierarchy/block.h"
#include "core/hierarchy/cell_order.h"
#include "core/hierarchy/cell_table.h"
#include "parallel/cpu_clock.h"
#include "parallel/finest_level.h"
#include "parallel/partition.h"
#include "parallel/refine_mesh.h"

namespace lodestone {
namespace {

// Everything that the blocks work on; becomes the storage of the finished hierarchy.
struct Build {
  std::vector<Triangle> triangles;  // of the finest level
  BlockPlan plan;
  Lattice lattice;                            // that the vertices stand on, if any
  std::vector<std::vector<CellBuild>> cells;  // by level, by rank
  AttributeSet attributes;
};

// One worker's simplifier and scratch memory.
struct Worker {
  std::unique_ptr<Simplifier> simplifier;
  BlockScratch block;
};

void check(const IndexedMesh& mesh, const BuildConfig& config) {
  if (!(config.sigma0 > 0 && config.sigma0 <= 2)) throw InputError("sigma0 must lie in (0, 2]");
  if (config.cell_triangles < 1) throw InputError("a cell must hold at least one triangle");
  if (config.finest_level > max_level)
    throw InputError("at most " + std::to_string(max_level) + " levels below the root are supported");
  if (mesh.triangles.empty()) throw InputError("the mesh has no triangles");
  if (mesh.positions.size() >= FinestVertices::shared_flag)
    throw ResourceError("the mesh has more than 2^31 vertices; vertex ids have 32 bits");
}

Placement placement_of(const BuildConfig& config) {
  return config.placement.value_or(default_placement(config.simplifier));
}

class HierarchyBuilder {
 public:
  HierarchyBuilder(Build& build, const BuildConfig& config, Scheduler& scheduler)
      : build_(build), config_(config), scheduler_(scheduler), finest_(static_cast<int>(build.plan.levels.size()) - 1) {
    workers_.resize(static_cast<std::size_t>(scheduler.workers()));
    for (Worker& worker : workers_) worker.simplifier = make_simplifier(config.simplifier, placement_of(config));
  }

  void run() {
    switch (config_.strategy) {
      case Strategy::serial:
        return run_serial();
      case Strategy::levels:
        return run_levels();
      case Strategy::graph:
        return run_graph();
    }
  }

 private:
  void run_serial() {
    for (std::uint32_t b = 0; b < build_.plan.blocks.size(); ++b) run_block(b, workers_.front());
  }

  void run_levels() {
    for (int l = finest_; l > 0; --l) {
      scheduler_.name_work(level_name(l));
      const auto level = static_cast<std::size_t>(l);
      scheduler_.for_chunks(build_.plan.block_count[level], 1, [&](ChunkRange range) {
        run_block(build_.plan.first_block[level] + static_cast<std::uint32_t>(range.begin), worker());
      });
    }
  }

  // A coarse block is worth more than a fine one: it releases what its cells carry for it.
  void run_graph() {
    TaskGraph graph{build_.plan.blocks.size(), build_.plan.dependencies, {}, [&](std::uint32_t b) { return label(b); }};
    graph.priority.reserve(graph.task_count);
    for (const Block& block : build_.plan.blocks) graph.priority.push_back(finest_ + 1 - block.level);
    scheduler_.run_graph(
        graph, [&](std::uint32_t b) { run_block(b, worker()); }, config_.cancel);
  }

  [[nodiscard]] static std::string level_name(int level) { return "level " + std::to_string(level); }
  [[nodiscard]] std::string label(std::uint32_t b) const { return level_name(build_.plan.blocks[b].level); }

  Worker& worker() { return workers_[static_cast<std::size_t>(scheduler_.worker_index())]; }

  void run_block(std::uint32_t index, Worker& worker) {
    if (config_.cancel && *config_.cancel) throw Cancelled{};
    const Block& block = build_.plan.blocks[index];
    const auto level = static_cast<std::size_t>(block.level);
    const LevelCells& parents = build_.plan.levels[level - 1];
    build_block(block, parents, build_.cells[level], build_.cells[level - 1], config_.sigma0, build_.attributes,
                *worker.simplifier, worker.block, build_.lattice);
    report_progress(worker.block.triangles.size());
  }

  // Work is proportional to the triangles that blocks consume; all levels together consume about 4/3 of the input.
  void report_progress(std::size_t triangles) {
    if (!config_.progress) return;
    const std::uint64_t done = consumed_ += triangles;
    const std::unique_lock lock(progress_, std::try_to_lock);
    if (!lock) return;
    const double expected = static_cast<double>(build_.triangles.size()) * 4 / 3;
    config_.progress(std::min(1.0, static_cast<double>(done) / expected));
  }

  Build& build_;
  const BuildConfig& config_;
  Scheduler& scheduler_;
  int finest_;
  std::vector<Worker> workers_;
  std::atomic<std::uint64_t> consumed_{0};
  std::mutex progress_;
};

// Each cell for itself, then the parents, which name places in another cell. Nothing that a cell's figures rest on
// changes.
void order_cells(Build& build, Scheduler& scheduler) {
  struct Place {
    std::size_t level;
    CellRank rank;
  };
  std::vector<Place> all;
  std::vector<std::vector<std::vector<std::uint32_t>>> moved(build.cells.size());  // by level, by rank: see order_cell
  for (std::size_t l = 0; l < build.cells.size(); ++l) {
    moved[l].resize(build.cells[l].size());
    for (CellRank rank = 0; rank < build.cells[l].size(); ++rank) all.push_back({l, rank});
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

// The finished tables: views of the payloads, levels' statistics from their cells' in cell order.
void assemble_level(const Build& build, std::size_t l, Hierarchy& out) {
  const LevelCells& table = build.plan.levels[l];
  Level level;
  level.first_cell = static_cast<std::uint32_t>(out.cells.size());
  level.cell_count = static_cast<std::uint32_t>(table.codes.size());
  const std::uint32_t first_parent = l > 0 ? out.levels.back().first_cell : 0;
  const float h = cell_size(static_cast<int>(l));
  for (CellRank rank = 0; rank < table.codes.size(); ++rank) {
    const CellBuild& from = build.cells[l][rank];
    Cell cell;
    cell.code = table.codes[rank];
    cell.parent = l > 0 ? first_parent + table.parent[rank] : no_cell;
    if (!table.first_child.empty()) {
      cell.first_child = level.first_cell + level.cell_count + table.first_child[rank];
      cell.child_count = table.first_child[rank + 1] - table.first_child[rank];
    }
    cell.bounds = from.bounds;
    cell.max_displacement = from.max_displacement;
    cell.error = from.error;
    cell.positions = from.slab.positions;
    cell.normals = from.slab.normals;
    cell.attributes = {from.slab.uv, from.slab.colours, from.slab.materials};
    if (l > 0) cell.parents = from.slab.parents;
    cell.shared_ids = from.slab.shared_ids;
    cell.triangles = from.triangles;
    level.triangles += from.triangles.size();
    level.vertices += from.vertex_count();
    for (std::size_t m = 0; m < level.reach.size(); ++m) level.reach[m] = std::max(level.reach[m], from.reach[m]);
    level.diameter = std::max(level.diameter, from.diameter);
    level.max_edge = std::max(level.max_edge, from.max_edge);
    level.long_edges += from.long_edges;
    if (from.error > 0)
      level.error = std::max(level.error, std::nextafter(from.error / h, std::numeric_limits<float>::max()));
    out.cells.push_back(cell);
  }
  out.levels.push_back(level);
}

// The finest level, and empty cells on the others. What the partition alone needs is released here.
void partition_finest(IndexedMesh&& mesh, int finest, Build& build, Hierarchy& out, Scheduler& scheduler) {
  Partition partition = partition_mesh(std::move(mesh), finest, scheduler);
  out.provenance.fingerprint = partition.fingerprint;
  build.plan = plan_blocks(partition.codes, finest);
  for (int l = 0; l < finest; ++l)
    build.cells.emplace_back(build.plan.levels[static_cast<std::size_t>(l)].codes.size());
  build.triangles = std::move(partition.triangles);
  build.cells.push_back(make_finest_cells(std::move(partition), finest, out.sigma0, scheduler));
  // The lattice has moved the input, and the middles of split edges once more.
  const float moved = (out.provenance.refined ? 2 : 1) * build.lattice.error();
  for (CellBuild& cell : build.cells.back()) cell.error = moved;
}

}  // namespace

Strategy strategy(std::string_view name) {
  for (const Strategy s : {Strategy::serial, Strategy::levels, Strategy::graph})
    if (name == name_of(s)) return s;
  throw InputError("unknown strategy '" + std::string(name) + "'; known are serial, levels, graph");
}

std::string_view name_of(Strategy strategy) {
  constexpr std::string_view names[] = {"serial", "levels", "graph"};
  return names[static_cast<std::size_t>(strategy)];
}

Hierarchy build_hierarchy(IndexedMesh&& mesh, const BuildConfig& config, Scheduler& scheduler, BuildReport* report) {
  check(mesh, config);
  const CpuClock total;
  const auto build = std::make_shared<Build>();
  Hierarchy out;
  out.transform = mesh.transform;
  build->lattice = mesh.transform.lattice;
  out.sigma0 = config.sigma0;
  out.provenance.simplifier = static_cast<std::uint32_t>(config.simplifier);
  out.attributes = build->attributes = attributes_of(mesh);
  out.materials = std::move(mesh.wedges.materials);
  out.textures = std::move(mesh.wedges.textures);
  out.provenance.placement = static_cast<std::uint32_t>(placement_of(config));

  scheduler.name_work("partition");
  const CpuClock refine_clock;
  const bool choose = config.finest_level < 0;
  const int finest = choose ? choose_finest_level(mesh, config.cell_triangles) : config.finest_level;
  out.provenance.cell_triangles = choose ? config.cell_triangles : 0;
  RefineReport refinement;
  if (config.refine) {
    refinement = refine_mesh(mesh, double{config.sigma0} * cell_size(finest), scheduler);
    out.provenance.refined = true;
  }
  out.provenance.input_vertices = mesh.positions.size();
  out.provenance.input_triangles = mesh.triangles.size();
  const StageTime refine_time = refine_clock.elapsed();
  const CpuClock partition_clock;
  partition_finest(std::move(mesh), finest, *build, out, scheduler);
  const StageTime partition_time = partition_clock.elapsed();

  const CpuClock hierarchy_clock;
  HierarchyBuilder(*build, config, scheduler).run();
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
