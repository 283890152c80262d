// Cracks and pops of the drawn surface over a flight, as columns: the same for every system.
#pragma once

#include <optional>
#include <vector>

#include "experiments/studies/experiment.h"
#include "experiments/studies/row_verdict.h"

namespace lodestone {

// From one frame to the next. Lengths in per cent of the model's extent.
struct JumpSample {
  double largest = 0, p99 = 0, pixels = 0, p99_pixels = 0;
  std::optional<double> per_step{};    // over the way of the viewpoint, where it moves
  std::optional<double> over_bound{};  // of the analytic bound, where there is one
};

// One frame, whole and before culling.
struct SurfaceSample {
  double triangles = 0, open_edges = 0, gap = 0, gap_mean = 0, gap_pixels = 0, gap_mean_pixels = 0, t_junctions = 0;
  std::optional<double> torn_pixels{}, leak_pixels{};  // of closed models
  std::optional<JumpSample> jump{};                    // where it follows the frame before
};

class SurfaceSummary {
 public:
  void add(const SurfaceSample& sample) { samples_.push_back(sample); }

  [[nodiscard]] static std::vector<ColumnInfo> columns();
  void add_to(Row& row) const;
  // No crack where a row says that it is admissible; nor a jump beyond the bound, if the blend is continuous.
  static void check(RowVerdict& verdict, bool continuous_blend);

 private:
  std::vector<SurfaceSample> samples_;
};

}  // namespace lodestone
