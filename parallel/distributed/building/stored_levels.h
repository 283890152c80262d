// The cells of a rank in a scratch file: a block reads its cells, makes the coarser ones and writes both.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/files/scratch_file.h"
#include "parallel/distributed/building/kept_blocks.h"
#include "parallel/distributed/building/stored_finest.h"
#include "parallel/distributed/rank_blocks.h"
#include "parallel/distributed/rank_save.h"
#include "parallel/out_of_core/cell_store.h"

namespace lodestone {

// Some cells of a level, by code.
struct StoredPart {
  std::vector<CellCode> codes;  // ascending
  std::vector<StoredCell> cells;
};

struct StoredSetting {
  const RankMemory& memory;
  KeptBlocks* kept = nullptr;
};

class StoredLevels final : public RankLevels {
 public:
  // As build_rank_levels. Consumes the finest level, whose memory is released when its blocks have run. `kept`: has the
  // cells, and some of the blocks already; null for files without names. Memory: some 150 bytes per cell (250 of blocks
  // that are kept), and the blocks at hand.
  StoredLevels(std::unique_ptr<StoredFinest> finest, int level, const BlockSetting& setting,
               const StoredSetting& stored, Ranks& ranks, Scheduler& scheduler);

  [[nodiscard]] std::size_t level_count() const override { return levels_.size(); }
  [[nodiscard]] std::span<const CellCode> codes(std::size_t level) const override { return levels_[level].codes; }
  [[nodiscard]] Summary summary(std::size_t level, std::size_t index) const override;
  void visit(std::size_t level, std::size_t index, const Visit& visit) const override;
  [[nodiscard]] SharedBorder border(std::size_t level, std::size_t index, BorderRoom& room) const override;
  [[nodiscard]] std::uint64_t compared_copies(std::uint64_t copies) const override;

 private:
  [[nodiscard]] StoredPart run_blocks(const StoredFinest* finest, int level, const BlockSetting& setting, Ranks& ranks,
                                      Scheduler& scheduler);
  [[nodiscard]] StoredPart exchange(const StoredPart& made, int level, const CellOwners& owners, Ranks& ranks);

  StoredSetting stored_;
  std::unique_ptr<ScratchFile> nameless_;  // if none is kept
  CellStore store_;
  std::size_t lanes_ = 1;
  std::vector<StoredPart> levels_;
};

}  // namespace lodestone
