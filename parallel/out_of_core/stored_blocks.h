// The cells of a hierarchy in a scratch file: a block reads its cells, makes the coarser ones and writes both, so that
// memory does not depend on how many there are.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "parallel/hierarchy/build_blocks.h"
#include "parallel/out_of_core/cell_store.h"
#include "parallel/out_of_core/spilled_finest.h"

namespace lodestone {

class StoredBlocks final : public CellStorage {
 public:
  StoredBlocks(const BlockPlan& plan, const CellRuns& spilled, const SpilledFinest& finest, CellStore& store,
               std::size_t lanes);

  // Calls `record` after a block is in the file, with the bytes that take_record() understands; from any thread.
  void on_record(std::function<void(std::span<const std::byte>)> record) { record_ = std::move(record); }
  // A block of an interrupted build with the same plan is not run again. Returns false for bytes of another kind.
  bool take_record(std::span<const std::byte> record);

  [[nodiscard]] bool is_done(std::uint32_t block) const override { return done_[block] != 0; }
  void load(const Block& block, std::size_t lane) override;
  void store(std::uint32_t block) override;
  // For a plan of one level, which has no blocks.
  void store_root();

  [[nodiscard]] std::vector<std::vector<CellBuild>>& in_memory() { return cells_; }
  [[nodiscard]] std::vector<std::vector<StoredCell>> stored() && { return std::move(stored_); }

  // Bytes of memory for a block of so many triangles of the finest level.
  static constexpr std::uint64_t bytes_per_triangle = 320;
  // Triangles of the largest block.
  [[nodiscard]] static std::uint64_t largest_block(const BlockPlan& plan, const CellRuns& spilled);

 private:
  void record(std::uint32_t index) const;
  template <class Visit>
  void for_children(const Block& block, const Visit& visit) const;

  const BlockPlan& plan_;
  const CellRuns& spilled_;
  const SpilledFinest& finest_;
  CellStore& store_;
  std::function<void(std::span<const std::byte>)> record_;
  std::vector<std::vector<CellBuild>> cells_;    // by level, by rank; empty except for those of the blocks at hand
  std::vector<std::vector<StoredCell>> stored_;  // likewise, but all of them
  std::vector<std::uint8_t> done_;               // by block
  std::vector<SpilledFinestScratch> scratch_;    // by lane
};

}  // namespace lodestone
