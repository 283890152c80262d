#include "parallel/build/run_blocks.h"

#include <string>

namespace lodestone {
namespace {

std::string level_name(int level) { return "level " + std::to_string(level); }

int finest_of(const BlockPlan& plan) { return static_cast<int>(plan.levels.size()) - 1; }

void run_levels(const BlockPlan& plan, Scheduler& scheduler, const std::function<void(std::uint32_t)>& run) {
  for (int l = finest_of(plan); l > 0; --l) {
    scheduler.name_work(level_name(l));
    const auto level = static_cast<std::size_t>(l);
    scheduler.for_chunks(plan.block_count[level], 1, [&](ChunkRange range) {
      run(plan.first_block[level] + static_cast<std::uint32_t>(range.begin));
    });
  }
}

// A coarse block is worth more than a fine one: it releases what its cells carry for it.
void run_graph(const BlockPlan& plan, Scheduler& scheduler, const CancelFlag* cancel,
               const std::function<void(std::uint32_t)>& run) {
  TaskGraph graph{
      plan.blocks.size(), plan.dependencies, {}, [&](std::uint32_t b) { return level_name(plan.blocks[b].level); }};
  graph.priority.reserve(graph.task_count);
  for (const Block& block : plan.blocks) graph.priority.push_back(finest_of(plan) + 1 - block.level);
  scheduler.run_graph(graph, run, cancel);
}

}  // namespace

void run_blocks(const BlockPlan& plan, Strategy strategy, Scheduler& scheduler, const CancelFlag* cancel,
                const std::function<void(std::uint32_t)>& run) {
  const auto run_unless_cancelled = [&](std::uint32_t b) {
    if (cancel && *cancel) throw Cancelled{};
    run(b);
  };
  switch (strategy) {
    case Strategy::serial:
      for (std::uint32_t b = 0; b < plan.blocks.size(); ++b) run_unless_cancelled(b);
      return;
    case Strategy::levels:
      return run_levels(plan, scheduler, run_unless_cancelled);
    case Strategy::graph:
      return run_graph(plan, scheduler, cancel, run_unless_cancelled);
  }
}

}  // namespace lodestone
