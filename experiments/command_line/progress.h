// A progress bar for people: on standard error, only when that is a terminal and the work takes over a second. Work
// that cannot tell how far it is shows its name meanwhile.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace lodestone {

class Progress {
 public:
  // Programs such as mpirun take the standard error of those that they start, and have a terminal in common with them
  // if they are on one machine.
  enum class Start { by_hand, by_launcher };
  // `quiet` shows nothing at all.
  Progress(std::string label, bool quiet, Start start = Start::by_hand);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Names what is under way and says nothing of how long it takes, until update() is called. Rate and time left count
  // from here.
  void phase(std::string label);

  // The whole work of the phase is `amount` of `unit`, shown beside the share, with the rate.
  void measure(double amount, std::string unit);

  // Share done in [0, 1]; calls more often than ten times a second cost next to nothing.
  void update(double share);

  // Takes the bar away before other text is printed; the destructor does so, too.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_, unit_;
  double amount_ = 0;         // in the phase; 0: not known
  std::FILE* out_ = nullptr;  // null: nothing is shown
  bool drawn_ = false;        // the line is not empty
  Clock::time_point start_, phase_start_, last_;
};

// The line of a bar: `share` in [0, 1] of `amount` units, `seconds` after the phase began. No amount, no rate.
//     building   [#########.....................]  31 %  17.4 of 56 M triangles, 4.9 M/s, 8 s left
[[nodiscard]] std::string progress_line(const std::string& label, double share, double seconds, double amount = 0,
                                        const std::string& unit = {});

}  // namespace lodestone
