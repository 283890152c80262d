#include "experiments/studies/frame_rounds.h"

#include <algorithm>

#include "experiments/studies/rounds.h"

namespace lodestone {

void FrameRounds::add(std::span<const StageTime> frames) {
  StageTime sum;
  double worst = 0;
  for (const StageTime& frame : frames) {
    sum.seconds += frame.seconds, sum.cpu_seconds += frame.cpu_seconds;
    worst = std::max(worst, frame.seconds);
  }
  const auto count = static_cast<double>(frames.size());
  wall_ms.push_back(1000 * sum.seconds / count);
  cpu_ms.push_back(1000 * sum.cpu_seconds / count);
  worst_ms.push_back(1000 * worst);
}

std::vector<ColumnInfo> frame_columns(const std::string& meaning) {
  std::vector<ColumnInfo> columns;
  add_spread_columns(columns, "frame_ms", "ms", meaning + "; mean over the path, of the rounds");
  add_spread_columns(columns, "frame_cpu_ms", "ms",
                     "processor time of a frame, all threads; mean over the path, of the rounds");
  columns.push_back(
      {"frame_ms_worst", "ms", "slowest frame of the path, median of the rounds", ColumnInfo::Kind::cost});
  return columns;
}

void add_frames(Row& row, const FrameRounds& rounds) {
  add_spread(row, "frame_ms", rounds.wall_ms);
  add_spread(row, "frame_cpu_ms", rounds.cpu_ms);
  row["frame_ms_worst"] = median_of(rounds.worst_ms);
}

void check_frames(RowVerdict& verdict) {
  verdict.spread("frame_ms");
  verdict.in_order("frame_ms", "frame_ms_worst");
  verdict.in_order("frame_cpu_ms_min", "frame_cpu_ms");
  verdict.in_order("frame_cpu_ms", "frame_cpu_ms_max");
}

}  // namespace lodestone
