// Estimates the share of a sweep that is done from the duration of its repetitions so far.
#pragma once

#include <cstddef>
#include <map>
#include <optional>

namespace lodestone {

// A repetition is expected to take what the last one of the same run took; of a run that has none yet, the mean of all.
class TimeLeft {
 public:
  void expected(std::size_t run) { ++left_[run]; }
  // `counted`: it was expected, and is work of this session.
  void ended(std::size_t run, std::optional<double> seconds, bool counted) {
    if (counted) {
      --left_[run];
      done_ += seconds.value_or(of(run));
    }
    if (!seconds) return;
    last_[run] = *seconds;
    sum_ += *seconds;
    ++known_;
  }

  // Seconds that a repetition of the run is expected to take.
  [[nodiscard]] double of(std::size_t run) const {
    const auto found = last_.find(run);
    if (found != last_.end()) return found->second;
    return known_ > 0 ? sum_ / static_cast<double>(known_) : 0;
  }

  // Share of the session's work that is done, when of the repetitions under way so many seconds, and such a share of
  // them in sum, are done.
  [[nodiscard]] double share(double seconds, double shares) const {
    double left = 0, count = 0;
    for (const auto& [run, repetitions] : left_) {
      left += static_cast<double>(repetitions) * of(run);
      count += static_cast<double>(repetitions);
    }
    if (done_ + left > 0) return (done_ + seconds) / (done_ + left);
    return count > 0 ? shares / count : 1;
  }

 private:
  std::map<std::size_t, std::size_t> left_;  // repetitions of a run that have not ended
  std::map<std::size_t, double> last_;       // seconds
  double done_ = 0, sum_ = 0;
  std::size_t known_ = 0;
};

}  // namespace lodestone
