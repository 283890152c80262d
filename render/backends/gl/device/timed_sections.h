// The device's time by part of a frame.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "render/backends/gl/device/object.h"

namespace lodestone {

// One part is timed at a time; timers are kept for the next frame.
class GlSections {
 public:
  // Ends the part before it.
  void begin(const std::string& name) {
    end();
    if (names_.size() == timers_.size()) timers_.emplace_back();
    glBeginQuery(GL_TIME_ELAPSED, timers_[names_.size()].name());
    names_.push_back(name);
    running_ = true;
  }
  void end() {
    if (std::exchange(running_, false)) glEndQuery(GL_TIME_ELAPSED);
  }
  // Milliseconds of the parts; waits. None counts for more than `maximum`: frames of many triangles make llvmpipe
  // forget when the query began, and it then counts from the start of the machine.
  [[nodiscard]] std::map<std::string, double> results(double most) {
    std::map<std::string, double> milliseconds;
    for (std::size_t k = 0; k < names_.size(); ++k) {
      GLuint64 nanoseconds = 0;
      glGetQueryObjectui64v(timers_[k].name(), GL_QUERY_RESULT, &nanoseconds);
      milliseconds[names_[k]] += std::min(static_cast<double>(nanoseconds) * 1e-6, most);
    }
    names_.clear();
    return milliseconds;
  }

 private:
  std::vector<GlTimer> timers_;
  std::vector<std::string> names_;
  bool running_ = false;
};

}  // namespace lodestone
