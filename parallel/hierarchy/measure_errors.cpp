#include "parallel/hierarchy/measure_errors.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <vector>

#include "core/hierarchy/construct/cell_error.h"
#include "core/hierarchy/construct/image_bound.h"
#include "core/math/round_up.h"

namespace lodestone {
namespace {

constexpr double negligible_ratio = 1e-5;  // of the cell size: no error below it makes a difference
constexpr std::size_t tree_grain = 4;      // cells

// Cells of the finest level.
struct CellRange {
  CellRank first, end;
};

class ErrorMeasurement {
 public:
  ErrorMeasurement(Hierarchy& hierarchy, const MeasureConfig& config, Scheduler& scheduler)
      : hierarchy_(hierarchy),
        config_(config),
        scheduler_(scheduler),
        below_(hierarchy.cells.size()),
        errors_(hierarchy.cells.size()) {
    for (int w = 0; w < scheduler.workers(); ++w) meters_.emplace_back(CellErrorConfig{config.tolerance});
  }

  void run() {
    find_descendants();
    scheduler_.name_work("index the finest level");
    const LevelSurface finest = surface_of(hierarchy_.finest());
    for (int level = hierarchy_.finest() - 1; level >= 0; --level) {
      scheduler_.name_work("measure level " + std::to_string(level));
      measure_level(level, finest);
    }
    store();
  }

  [[nodiscard]] MeasureReport report() const {
    MeasureReport result;
    for (const CellErrorMeter& meter : meters_) {
      result.queries += meter.work().queries;
      result.pieces += meter.work().pieces;
      result.tests += meter.work().tests;
    }
    for (int l = 0; l < hierarchy_.finest(); ++l) {
      const Level& level = hierarchy_.levels[static_cast<std::size_t>(l)];
      for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
        result.stopped += !errors_[c].complete;
        result.excess = std::max(result.excess, (errors_[c].bound - errors_[c].found) / hierarchy_.cell_size(l));
      }
    }
    return result;
  }

 private:
  void check_cancelled() const {
    if (config_.cancel && *config_.cancel) throw Cancelled{};
  }

  // The cells of the finest level below each cell: children are consecutive, level by level.
  void find_descendants() {
    const Level& finest = hierarchy_.levels.back();
    for (auto c = static_cast<std::uint32_t>(hierarchy_.cells.size()); c-- > 0;) {
      const Cell& cell = hierarchy_.cells[c];
      const CellRank rank = finest.rank_of(CellId(c));  // if it is one of the finest
      below_[c] = c >= finest.first_cell ? CellRange{rank, CellRank(rank + 1)}
                                         : CellRange{below_[cell.first_child].first, below_[cell.end_child() - 1].end};
    }
  }

  [[nodiscard]] LevelSurface surface_of(int level) {
    LevelSurface surface(hierarchy_, level);
    scheduler_.for_chunks(surface.cell_count(), tree_grain, [&](ChunkRange range) {
      check_cancelled();
      for (CellRank c(range.begin); c < range.end; ++c) surface.build_cell(c);
    });
    surface.build_rest();
    return surface;
  }

  void measure_level(int level, const LevelSurface& finest) {
    const LevelSurface surface = surface_of(level);
    scheduler_.for_chunks(surface.cell_count(), 1, [&](ChunkRange range) {
      check_cancelled();
      const CellRank rank(range.begin);
      const CellId id = hierarchy_.levels[static_cast<std::size_t>(level)].id_of(rank);
      const CellRange below = below_[id];
      std::size_t triangles = hierarchy_.cells[id].triangles.size();
      for (CellRank c = below.first; c < below.end; ++c) triangles += finest.triangle_count(c);
      const double tests = std::ceil(config_.tests / hierarchy_.finest() * static_cast<double>(triangles));
      measure_cell(id, {surface, rank, finest, below.first, below.end, 0,
                        negligible_ratio * hierarchy_.cell_size(level), static_cast<std::uint64_t>(tests)});
      report_progress();
    });
  }

  void measure_cell(CellId id, CellErrorQuery query) {
    const Cell& cell = hierarchy_.cells[id];
    double found = 0;
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
      query.known = std::max(query.known, errors_[k].bound);
      found = std::max(found, errors_[k].found);
    }
    query.largest = [&] { return image_bound(hierarchy_, id, query.first, query.end); };
    errors_[id] = meters_[static_cast<std::size_t>(scheduler_.worker_index())].measure(query);
    errors_[id].found = std::max(errors_[id].found, found);
  }

  void store() {
    const float moved = hierarchy_.cells.back().error;
    for (std::size_t l = 0; l + 1 < hierarchy_.levels.size(); ++l) {
      Level& level = hierarchy_.levels[l];
      float largest = 0;
      for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
        hierarchy_.cells[c].border_errors = {};  // estimates
        hierarchy_.cells[c].error = float_above(moved + errors_[c].bound + distance_rounding);
        largest = std::max(largest, hierarchy_.cells[c].error);
      }
      level.error = largest / hierarchy_.cell_size(static_cast<int>(l));
    }
    hierarchy_.signatures = nullptr;  // theirs are of the old ones
    hierarchy_.provenance.measured_errors = true;
  }

  // Most of the work is done on the finest of the coarse levels, which has most of the cells.
  void report_progress() {
    if (!config_.progress) return;
    const std::uint64_t done = ++done_;
    const std::unique_lock lock(progress_, std::try_to_lock);
    const std::uint64_t all = hierarchy_.cells.size() - hierarchy_.levels.back().cell_count;
    if (lock) config_.progress(static_cast<double>(done) / static_cast<double>(all));
  }

  Hierarchy& hierarchy_;
  const MeasureConfig& config_;
  Scheduler& scheduler_;
  std::vector<CellErrorMeter> meters_;  // by worker
  std::vector<CellRange> below_;        // by cell, as in Hierarchy::cells
  std::vector<CellError> errors_;       // likewise, without what the finest level has
  std::atomic<std::uint64_t> done_{0};
  std::mutex progress_;
};

}  // namespace

MeasureReport measure_errors(Hierarchy& hierarchy, const MeasureConfig& config, Scheduler& scheduler) {
  ErrorMeasurement measurement(hierarchy, config, scheduler);
  measurement.run();
  return measurement.report();
}

}  // namespace lodestone
