// An error map as a picture that can be read: colours over a range that fits the errors, and a bar that says which is
// which.
#pragma once

#include "experiments/metrics/pictures/error_map.h"

namespace lodestone {

// The smallest of 1, 2, 5 times a power of ten, at most 1, that 99.9 % of the pixels do not exceed; 1 without errors.
[[nodiscard]] double heat_map_top(const ErrorMap& map);

// Black for 0, through purple, red and yellow to white for `top` and more, brighter all the way. A bar beneath has
// these colours from left to right, with 0, half of `top` and `top` below their places; the picture is that much
// higher.
[[nodiscard]] Image heat_map(const ErrorMap& map, double top);
[[nodiscard]] Image heat_map(const ErrorMap& map);                  // up to the top of the map
[[nodiscard]] Image heat_colours(const ErrorMap& map, double top);  // the same without the bar

inline constexpr int heat_bar_height = 10;  // pixels, below a gap of heat_bar_gap
inline constexpr int heat_bar_gap = 4;
inline constexpr int heat_label_height = 21;  // pixels, below the bar

}  // namespace lodestone
