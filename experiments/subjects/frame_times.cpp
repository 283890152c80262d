#include "experiments/subjects/frame_times.h"

#include <algorithm>

#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {

using enum ColumnInfo::Kind;

void FrameRounds::add(std::span<const StageTime> frames) {
  StageTime sum;
  std::vector<double> wall;
  for (const StageTime& frame : frames) {
    sum.seconds += frame.seconds, sum.cpu_seconds += frame.cpu_seconds;
    wall.push_back(1000 * frame.seconds);
  }
  const auto count = static_cast<double>(frames.size());
  wall_ms.push_back(1000 * sum.seconds / count);
  cpu_ms.push_back(1000 * sum.cpu_seconds / count);
  worst_ms.push_back(*std::ranges::max_element(wall));
  median_ms.push_back(median_of(std::move(wall)));
}

std::vector<ColumnInfo> frame_columns(const std::string& meaning) {
  std::vector<ColumnInfo> columns;
  add_spread_columns(columns, "frame_ms", "ms", meaning + "; mean over the path, of the rounds");
  add_spread_columns(columns, "frame_cpu_ms", "ms",
                     "processor time of a frame, all threads; mean over the path, of the rounds");
  append(columns, {{"frame_ms_worst", "ms", "slowest frame of the path, median of the rounds", cost},
                   {"frame_ms_median", "ms", "median frame of the path, median of the rounds", cost}});
  return columns;
}

void add_frames(Row& row, const FrameRounds& rounds) {
  add_spread(row, "frame_ms", rounds.wall_ms);
  add_spread(row, "frame_cpu_ms", rounds.cpu_ms);
  row["frame_ms_worst"] = median_of(rounds.worst_ms);
  row["frame_ms_median"] = median_of(rounds.median_ms);
}

std::vector<ColumnInfo> flight_columns() {
  std::vector<ColumnInfo> columns{
      {"triangles", "", "triangles drawn in a frame, mean", cost},
      {"cells", "", "cells drawn in a frame, mean", cost},
      {"select_ms", "ms", "radii and selection of a frame; mean over the path, median of the rounds", cost}};
  append(columns, frame_columns("a frame, from camera to picture"));
  return columns;
}

Row to_row(const FlightTimes& times) {
  Row row{{"triangles", times.triangles}, {"cells", times.cells}, {"select_ms", median_of(times.select_ms)}};
  add_frames(row, times.frames);
  return row;
}

}  // namespace lodestone
