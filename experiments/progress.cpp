#include "experiments/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lodestone {

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)), shown_(!quiet && isatty(STDERR_FILENO)), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(double share) {
  if (!shown_) return;
  const Clock::time_point now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (seconds < 1 || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  draw(std::clamp(share, 0.0, 1.0), seconds);
}

void Progress::draw(double share, double seconds) {
  constexpr int width = 30;
  const int filled = static_cast<int>(share * width);
  const std::string bar =
      std::string(static_cast<std::size_t>(filled), '#') + std::string(static_cast<std::size_t>(width - filled), '.');
  const double left = share > 0.01 ? seconds * (1 - share) / share : 0;
  fmt::print(stderr, "\r{:<10} [{}] {:3.0f} %  {:.0f} s left \x1b[K", label_, bar, 100 * share, left);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace lodestone
