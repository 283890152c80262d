#include "parallel/hierarchy/build_blocks.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "core/simplify/simplifiers.h"

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

// "cells 4 0 8 to 7 3 11 of level 5"
std::string place_of(const Block& block) {
  const auto text_of = [](const CellCoord& at) {
    return std::to_string(at.x) + " " + std::to_string(at.y) + " " + std::to_string(at.z);
  };
  return "cells " + text_of(block.range.lo) + " to " + text_of(block.range.hi) + " of level " +
         std::to_string(block.level);
}

// A coarse block is worth more than a fine one: it releases what its cells carry for it.
void run_graph(const BlockPlan& plan, Scheduler& scheduler, const CancelFlag* cancel,
               const std::function<void(std::uint32_t)>& run) {
  TaskGraph graph{.task_count = plan.blocks.size(),
                  .edges = plan.dependencies,
                  .priority = {},
                  .label = [&](std::uint32_t b) { return level_name(plan.blocks[b].level); },
                  .place = [&](std::uint32_t b) { return place_of(plan.blocks[b]); }};
  graph.priority.reserve(graph.task_count);
  for (const Block& block : plan.blocks) graph.priority.push_back(finest_of(plan) + 1 - block.level);
  scheduler.run_graph(graph, run, cancel);
}

// Calls run(block) for every block of the plan, after all that it depends on, from several workers at once unless the
// strategy is serial.
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

class BlockBuilder {
 public:
  BlockBuilder(const BlockWork& work, const BuildConfig& config) : work_(work), config_(config), lanes_(work.lanes) {
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
      lanes_[lane].simplifier = make_simplifier(config.simplifier, placement_of(config));
      free_lanes_.push_back(lane);
    }
  }

  void run(Scheduler& scheduler) {
    run_blocks(work_.plan, config_.strategy, scheduler, config_.cancel, [&](std::uint32_t b) {
      if (!work_.storage.is_done(b)) run_block(b);
    });
  }

 private:
  // A simplifier and scratch memory.
  struct Lane {
    std::unique_ptr<Simplifier> simplifier;
    BlockScratch block;
  };

  // A lane for as long as a block runs; waits for one.
  class Lease {
   public:
    explicit Lease(BlockBuilder& builder) : builder_(builder) {
      std::unique_lock lock(builder_.lane_mutex_);
      builder_.lane_freed_.wait(lock, [&] { return !builder_.free_lanes_.empty(); });
      lane = builder_.free_lanes_.back();
      builder_.free_lanes_.pop_back();
    }
    ~Lease() {
      {
        const std::lock_guard lock(builder_.lane_mutex_);
        builder_.free_lanes_.push_back(lane);
      }
      builder_.lane_freed_.notify_one();
    }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    std::size_t lane;

   private:
    BlockBuilder& builder_;
  };

  void run_block(std::uint32_t index) {
    const Block& block = work_.plan.blocks[index];
    const auto level = static_cast<std::size_t>(block.level);
    const Lease lease(*this);
    Lane& lane = lanes_[lease.lane];
    work_.storage.load(block, lease.lane);
    build_block({block, work_.plan.levels[level - 1], work_.cells[level], work_.cells[level - 1], config_.sigma0,
                 work_.plan.grids, work_.attributes, work_.lattice},
                *lane.simplifier, lane.block);
    work_.storage.store(index);
    report_progress(lane.block.triangles.size());
  }

  // Work is proportional to the triangles that blocks consume; all levels together consume about 4/3 of the input.
  void report_progress(std::size_t triangles) {
    if (!config_.progress) return;
    const std::uint64_t done = consumed_ += triangles;
    const std::unique_lock lock(reporting_, std::try_to_lock);
    const double expected = static_cast<double>(work_.triangles) * 4 / 3;
    if (lock) config_.progress(std::min(1.0, static_cast<double>(done) / expected));
  }

  const BlockWork& work_;
  const BuildConfig& config_;
  std::vector<Lane> lanes_;
  std::vector<std::size_t> free_lanes_;
  std::mutex lane_mutex_;
  std::condition_variable lane_freed_;
  std::atomic<std::uint64_t> consumed_{0};
  std::mutex reporting_;
};

}  // namespace

Placement placement_of(const BuildConfig& config) {
  return config.placement ? *config.placement : placements_of(config.simplifier).front();
}

void describe_config(const BuildConfig& config, Hierarchy& out) {
  out.sigma0 = config.sigma0;
  out.grids = grids_of(config);
  out.provenance.simplifier = config.simplifier;
  out.provenance.placement = static_cast<std::uint32_t>(placement_of(config));
  out.provenance.cell_triangles = config.finest_level < 0 ? config.cell_triangles : 0;
}

void build_blocks(const BlockWork& work, const BuildConfig& config, Scheduler& scheduler) {
  BlockBuilder(work, config).run(scheduler);
}

}  // namespace lodestone
