// From a tolerance to numbers: the selection radius r_l and the morph band [a_l, c_l] of every level.
#pragma once

#include <optional>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/projection.h"
#include "render/lod/blend.h"

namespace lodestone {

enum class RadiiRule : std::uint8_t {
  per_level,  // r_l = max(kappa0 h_l, what keeps a band of width beta h_{l+1} at level l+1): admissible for any kappa0
  uniform,    // r_l = kappa0 h_l, the published rule: admissible iff kappa0 > rho + 3 delta
};

struct RadiiConfig {
  RadiiRule rule = RadiiRule::per_level;
  DistanceMetric metric = DistanceMetric::euclidean;
  std::optional<float> kappa0 = {};  // least r_l / h_l; unset: from pixel_error at each level
  float pixel_error = 1;             // tau, in pixels; used when kappa0 is unset (per_level only)
  int image_height = 720;            // pixels
  float vertical_fov = 0.785f;       // radians
  float aspect = 16.0f / 9.0f;       // width over height: the angle to the image corner
  float beta = 0.5f;                 // least band width at level l over h_l; > 0
  float delta = 0;                   // guard for a selection stale by delta h_l; >= 0
  friend bool operator==(const RadiiConfig&, const RadiiConfig&) = default;
};

// The same rule for a picture of this size and a camera of this field of view, in radians.
[[nodiscard]] RadiiConfig for_picture(RadiiConfig config, ImageSize size, double vertical_fov);

struct Radii {
  DistanceMetric metric = DistanceMetric::euclidean;
  std::vector<float> select;      // r_l for l < L: a cell of level l is drawn iff d(v_p, B) >= r_l and no ancestor is
  std::vector<float> band_begin;  // a_l: lambda = 1 up to here
  std::vector<float> band_end;    // c_l: lambda = 0 from here; at level 0 infinite (lambda = 1)
  // r_{l-1} > a_l for all levels, guards included: the drawn surface is continuous in space and time.
  bool admissible = false;
};

// A relative guard for the rounding of distances: widens a_l and narrows c_l.
inline constexpr float rounding_guard = 4e-6f;

// Throws InputError for parameters out of range. An inadmissible uniform kappa0 gives admissible = false and bands that
// are steps at r_{l-1}; the caller decides if that is an error.
[[nodiscard]] Radii make_radii(const Hierarchy& hierarchy, const RadiiConfig& config);

// rho: a uniform kappa0 is admissible just above it.
[[nodiscard]] float reach(const Hierarchy& hierarchy, DistanceMetric metric);

}  // namespace lodestone
