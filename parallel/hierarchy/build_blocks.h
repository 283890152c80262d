// The blocks of a hierarchy, each simplified once the finer ones that it depends on are done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hierarchy/construct/block.h"
#include "core/hierarchy/construct/cell_table.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Holds the cells that no block is at work on. This one leaves them in memory.
class CellStorage {
 public:
  virtual ~CellStorage() = default;
  // True for a block whose cells were made by an earlier build.
  [[nodiscard]] virtual bool is_done(std::uint32_t /*block*/) const { return false; }
  // Brings the cells of a block into memory, with memory of a lane that no other block uses until store().
  virtual void load(const Block& /*block*/, std::size_t /*lane*/) {}
  // Takes the cells of a block and the coarser ones that it made.
  virtual void store(std::uint32_t /*block*/) {}
};

struct BlockWork {
  const BlockPlan& plan;
  std::vector<std::vector<CellBuild>>& cells;  // by level, by rank
  CellStorage& storage;
  AttributeSet attributes{};
  Lattice lattice{};            // on which the vertices lie, if any
  std::uint64_t triangles = 0;  // of the finest level
  std::size_t lanes = 1;        // blocks in memory at a time, at least 1
};

// Calls config.progress. Throws Cancelled when config.cancel is set.
void build_blocks(const BlockWork& work, const BuildConfig& config, Scheduler& scheduler);

// Fills what a hierarchy says about the configuration: sigma0, half levels, simplifier, placement and cell size.
void describe_config(const BuildConfig& config, Hierarchy& out);

[[nodiscard]] inline LevelGrids grids_of(const BuildConfig& config) { return {config.half_levels}; }

// Throws InputError for an unknown simplifier.
[[nodiscard]] Placement placement_of(const BuildConfig& config);

}  // namespace lodestone
