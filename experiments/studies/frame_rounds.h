// Times of frames along a path that is drawn in rounds.
//
// A round is one measurement, repeated: its value is the mean over the frames of the path. What frames differ by among
// themselves is the path's, no noise, and stands apart as the slowest frame of a round.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/studies/row_verdict.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {

// One value a round, in milliseconds.
struct FrameRounds {
  std::vector<double> wall_ms, cpu_ms;  // mean of a frame
  std::vector<double> worst_ms;         // slowest frame
  // The frames of a whole round; at least one.
  void add(std::span<const StageTime> frames);
};

// frame_ms and frame_cpu_ms with their least and most over the rounds, frame_ms_worst: their columns, their values, and
// whether they are in order.
[[nodiscard]] std::vector<ColumnInfo> frame_columns(const std::string& meaning);
void add_frames(Row& row, const FrameRounds& rounds);
void check_frames(RowVerdict& verdict);

}  // namespace lodestone
