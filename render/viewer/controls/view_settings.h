// Settings of one picture of the viewer; a split screen has two of them.
#pragma once

#include <span>
#include <string>

#include "render/camera/camera.h"
#include "render/lod/radii.h"

namespace lodestone::viewer {

struct ViewSettings {
  bool by_kappa0 = false;  // false: the tolerance in pixels sets the radii
  float pixel_error = 1;   // pixels of the picture that is drawn
  float kappa0 = 3;
  RadiiRule rule = RadiiRule::adaptive;  // of a tolerance in pixels alone; uniform: of kappa0 alone
  float beta = RadiiConfig{}.beta;
  Blend blend = Blend::smoothstep;
  int samples = 1;  // a pixel: 1 or 4

  bool tint = false;       // colour by level
  bool errors = false;     // colour by the error that a cell has stored
  bool band = false;       // colour by lambda, where vertices are on their way
  bool boxes = false;      // of the cells that are drawn
  bool wireframe = false;  // the edges of the triangles
  bool overdraw = false;   // instead of the picture: how many triangles lie over each other
  friend bool operator==(const ViewSettings&, const ViewSettings&) = default;
};

// Clamps values to their ranges and replaces NaN by the defaults, so that make_radii accepts them.
[[nodiscard]] ViewSettings clamped(ViewSettings settings);

// The metric is common to all views, as the loaded cells of a streamed file depend on it.
[[nodiscard]] RadiiConfig radii_config(const ViewSettings& settings, DistanceMetric metric);

// An assessment of settings, for a mark next to them.
struct Admissibility {
  bool admissible = true;  // no crack
  bool continuous = true;  // no pop: false for the blending function that jumps
  float least_kappa0 = 0;  // the uniform rule is admissible above it: rho + 3 delta
  std::string remark;      // the problem and its remedy; empty if there is none
};
[[nodiscard]] Admissibility admissibility(std::span<const Hierarchy* const> models, const ViewSettings& settings,
                                          DistanceMetric metric);

}  // namespace lodestone::viewer
