// Times of frames along a path that is drawn in rounds.
//
// A round is one measurement, repeated: its value is the mean over the frames of the path. Differences between the
// frames belong to the path and are not noise; the slowest frame of a round has a column of its own.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/subjects/row.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {

// One value per round, in milliseconds.
struct FrameRounds {
  std::vector<double> wall_ms, cpu_ms;  // mean of a frame
  std::vector<double> worst_ms;         // slowest frame
  std::vector<double> median_ms;        // median frame
  // Adds the frames of a whole round; at least one.
  void add(std::span<const StageTime> frames);
};

// frame_ms and frame_cpu_ms with their minima and maxima over the rounds, frame_ms_worst and frame_ms_median.
[[nodiscard]] std::vector<ColumnInfo> frame_columns(const std::string& meaning);
void add_frames(Row& row, const FrameRounds& rounds);

// A path drawn in rounds: its times, and the amount that a frame draws.
struct FlightTimes {
  FrameRounds frames;
  std::vector<double> select_ms;    // of a frame, mean of each round
  double triangles = 0, cells = 0;  // drawn in a frame, mean
};
[[nodiscard]] std::vector<ColumnInfo> flight_columns();
[[nodiscard]] Row to_row(const FlightTimes& times);

}  // namespace lodestone
