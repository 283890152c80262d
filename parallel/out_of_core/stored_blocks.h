// The blocks of a hierarchy whose cells are in a scratch file: each reads its cells, makes the coarser ones and writes
// both, so that memory does not depend on how many there are.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/hierarchy/build/block.h"
#include "core/hierarchy/build/cell_table.h"
#include "parallel/build/build.h"
#include "parallel/out_of_core/cell_store.h"
#include "parallel/out_of_core/spilled_finest.h"

namespace lodestone {

class StoredBlocks {
 public:
  struct Hooks {
    // After a block is in the file: the bytes that take_record() understands; from any thread.
    std::function<void(std::span<const std::byte>)> record;
    std::function<void(std::uint64_t)> done;  // how many triangles blocks have consumed; from any thread
  };

  // `lanes` blocks at most are in memory at a time.
  StoredBlocks(const BlockPlan& plan, const SpilledCells& spilled, const SpilledFinest& finest, CellStore& store,
               const BuildConfig& config, Lattice lattice, int lanes, Hooks hooks);

  // Of an interrupted build with the same plan: the block is not run again. False for bytes that are no such record.
  bool take_record(std::span<const std::byte> record);

  void run(Scheduler& scheduler);

  [[nodiscard]] std::vector<std::vector<StoredCell>> cells() && { return std::move(stored_); }

  // Bytes of memory for a block of so many triangles of the finest level.
  static constexpr std::uint64_t bytes_per_triangle = 320;
  // Triangles of the largest block.
  [[nodiscard]] static std::uint64_t largest_block(const BlockPlan& plan, const SpilledCells& spilled);

 private:
  struct Lane {
    std::unique_ptr<Simplifier> simplifier;
    BlockScratch block;
    SpilledFinestScratch finest;
  };
  class LaneLease;

  void run_block(std::uint32_t index);
  void load_cells(const Block& block, Lane& lane);
  void store_cells(const Block& block);
  void record(std::uint32_t index) const;
  template <class Visit>
  void for_children(const Block& block, const Visit& visit) const;

  const BlockPlan& plan_;
  const SpilledCells& spilled_;
  const SpilledFinest& finest_;
  CellStore& store_;
  const BuildConfig& config_;
  Lattice lattice_;
  Hooks hooks_;
  std::vector<std::vector<CellBuild>> cells_;    // by level, by rank; empty but for those of the blocks at hand
  std::vector<std::vector<StoredCell>> stored_;  // likewise
  std::vector<std::uint8_t> done_;               // by block
  std::vector<Lane> lanes_;
  std::vector<Lane*> free_lanes_;
  std::mutex lane_mutex_;
  std::condition_variable lane_freed_;
  std::atomic<std::uint64_t> consumed_{0};
};

}  // namespace lodestone
