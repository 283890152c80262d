// Colours of figures that span orders of magnitude, from blue for the least to red for the largest.
#pragma once

#include "core/math/vec3.h"

namespace lodestone::viewer {

// The least and the largest figure above 0; both 0 if there is none.
struct HeatRange {
  double least = 0, most = 0;
  void extend(double figure);  // by one above 0
};

// Figures fall into steps of equal ratio; step 0 is that of figures that are not above 0, and is grey.
inline constexpr int heat_steps = 16;
[[nodiscard]] int heat_step(double figure, const HeatRange& range);   // in [0, heat_steps]
[[nodiscard]] double heat_of_step(int step, const HeatRange& range);  // the middle of a step; step above 0
[[nodiscard]] Vec3f heat_colour(int step);

}  // namespace lodestone::viewer
