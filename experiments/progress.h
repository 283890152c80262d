// A progress bar for people: on standard error, only when that is a terminal and the work takes over a second.
#pragma once

#include <chrono>
#include <string>

namespace lodestone {

class Progress {
 public:
  // `quiet` shows nothing at all.
  Progress(std::string label, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Share done in [0, 1]; calls more often than ten times a second cost next to nothing.
  void update(double share);

 private:
  using Clock = std::chrono::steady_clock;
  void draw(double share, double seconds);

  std::string label_;
  bool shown_;          // may be shown at all
  bool drawn_ = false;  // something stands on the line
  Clock::time_point start_, last_;
};

}  // namespace lodestone
