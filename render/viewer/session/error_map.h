// The stored errors of cells as a heat map: a frame in which each model is drawn in parts, a part for the cells whose
// errors are alike, tinted by them. Backends draw it as any other frame.
#pragma once

#include <vector>

#include "render/scene/scene_view.h"
#include "render/viewer/session/heat_scale.h"

namespace lodestone::viewer {

// That of the errors of all cells, in units of the scene.
[[nodiscard]] HeatRange error_range(const SceneView& scene);

class ErrorMap {
 public:
  // The frame, and the range of the scene's errors. Valid until the next call.
  [[nodiscard]] const Frame& of(const Frame& frame, const SceneView& scene, const HeatRange& range);

 private:
  Frame frame_;
  std::vector<Selection> parts_;
};

}  // namespace lodestone::viewer
