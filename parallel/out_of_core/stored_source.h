// The cells of a hierarchy in a scratch file, to be written to a .lode file (parallel/hierarchy/save.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/construct/cell_order.h"
#include "core/hierarchy/model/hierarchy.h"
#include "parallel/hierarchy/save.h"
#include "parallel/out_of_core/cell_store.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct StoredHierarchy {
  Hierarchy tables;                            // without payloads
  std::vector<std::vector<StoredCell>> cells;  // by level, by rank
};

// Memory: a cell for each worker; to reorder, four bytes per vertex of the two levels at hand in addition.
class StoredSource final : public CellSource {
 public:
  enum class Order : std::uint8_t { as_stored, for_compression };  // the latter: BuildConfig::order_cells

  StoredSource(const StoredHierarchy& hierarchy, const CellStore& store, Order order, Scheduler& scheduler)
      : CellSource(hierarchy.tables),
        cells_(hierarchy.cells),
        store_(store),
        order_(order),
        scheduler_(scheduler),
        scratch_(static_cast<std::size_t>(scheduler.workers())) {}

  [[nodiscard]] std::vector<PayloadCounts> counts() const override;
  void begin_level(std::size_t level) override;
  void visit(CellId id, const Visit& visit) override;
  [[nodiscard]] bool keeps_payloads() const override { return false; }

 private:
  void reorder(CellBuild& build, CellRank rank, CellId parent);

  const std::vector<std::vector<StoredCell>>& cells_;
  const CellStore& store_;
  Order order_;
  Scheduler& scheduler_;
  std::vector<CellOrderScratch> scratch_;
  std::size_t level_ = 0;
  std::vector<std::vector<std::uint32_t>> moved_, parents_moved_;  // of this level and the next coarser one, by rank
};

}  // namespace lodestone
