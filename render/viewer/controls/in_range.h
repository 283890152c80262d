// Numbers that a file of settings may hold, brought into their range.
#pragma once

#include <algorithm>
#include <cmath>

namespace lodestone::viewer {

// The value, clamped to [least, most]; `fallback` if it is not finite.
[[nodiscard]] inline float in_range(float value, float least, float most, float fallback) {
  return std::isfinite(value) ? std::clamp(value, least, most) : fallback;
}

}  // namespace lodestone::viewer
