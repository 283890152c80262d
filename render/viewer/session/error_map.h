// The stored errors of cells as a heat map: a frame in which each model is drawn in parts, a part for the cells whose
// errors are alike, tinted by them. Backends draw it as any other frame.
#pragma once

#include <vector>

#include "render/scene/scene_view.h"

namespace lodestone::viewer {

// The range of the errors above 0 of all cells, in units of the scene; least = most = 0 if there are none.
struct ErrorRange {
  double least = 0, most = 0;
};
[[nodiscard]] ErrorRange error_range(const SceneView& scene);

// Errors fall into steps of equal ratio; step 0 is that of cells without one, those of the input.
inline constexpr int error_steps = 16;
[[nodiscard]] int error_step(double error, const ErrorRange& range);    // in [0, error_steps]
[[nodiscard]] double error_of_step(int step, const ErrorRange& range);  // the middle of a step; step above 0
[[nodiscard]] Vec3f error_colour(int step);

class ErrorMap {
 public:
  // The frame, and the range of the scene's errors. Valid until the next call.
  [[nodiscard]] const Frame& of(const Frame& frame, const SceneView& scene, const ErrorRange& range);

 private:
  Frame frame_;
  std::vector<Selection> parts_;
};

}  // namespace lodestone::viewer
