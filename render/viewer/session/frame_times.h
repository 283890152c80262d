// The times of the last frames, for a plot.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace lodestone::viewer {

class FrameTimes {
 public:
  void add(double milliseconds) {
    times_[next_ % times_.size()] = static_cast<float>(milliseconds);
    ++next_;
  }
  // Milliseconds, the oldest first.
  [[nodiscard]] std::vector<float> in_order() const {
    std::vector<float> times;
    const std::size_t count = std::min(next_, times_.size());
    for (std::size_t i = next_ - count; i < next_; ++i) times.push_back(times_[i % times_.size()]);
    return times;
  }
  [[nodiscard]] float last() const { return next_ ? times_[(next_ - 1) % times_.size()] : 0; }

 private:
  std::array<float, 120> times_{};
  std::size_t next_ = 0;  // frames so far
};

}  // namespace lodestone::viewer
