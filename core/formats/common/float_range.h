// The rounding of coordinates to float32, for formats that know nothing else.
#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/math/vec3.h"

namespace lodestone {

// Share of a model's longest extent beyond which rounding destroys it.
inline constexpr double tolerable_rounding = 1e-4;

struct FloatRounding {
  double extent = 0;   // longest side of the box
  double largest = 0;  // coordinate
  double moved = 0;    // largest distance by which rounding moves a coordinate; infinite beyond the range of float
  [[nodiscard]] bool destroys() const { return moved > tolerable_rounding * extent; }
  // False if the size of the model is the cause.
  [[nodiscard]] bool is_far() const { return moved <= 0x1p-24 * largest; }
  // "so large", "so small" or "so far from the origin": the reason.
  [[nodiscard]] std::string so() const {
    if (largest > std::numeric_limits<float>::max()) return "so large";
    return is_far() ? "so far from the origin" : "so small";
  }
};

[[nodiscard]] inline FloatRounding float_rounding(const Box3d& box) {
  FloatRounding rounding;
  rounding.extent = std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
  rounding.largest = std::max({-box.lo.x, -box.lo.y, -box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  constexpr double half_of_least = 0.5 * double{std::numeric_limits<float>::denorm_min()};
  rounding.moved = rounding.largest > std::numeric_limits<float>::max()
                       ? std::numeric_limits<double>::infinity()
                       : std::max(0x1p-24 * rounding.largest, half_of_least);
  return rounding;
}

// Throws InputError unless glTF can hold a model in this box. Its positions are relative to the middle of the model, so
// that only size counts. `remedy`: what to do instead.
inline void require_gltf_range(const Box3d& box, const std::string& name, const std::string& remedy) {
  const Vec3d middle = 0.5 * (box.lo + box.hi);
  const FloatRounding rounding = float_rounding({box.lo - middle, box.hi - middle});
  if (rounding.destroys() || !is_finite(middle) || !is_finite(to_double(to_float(middle))))
    throw InputError(describe(
        name, "", "the model is " + rounding.so() + " that glTF, which has float32 alone, cannot hold it", remedy));
}

}  // namespace lodestone
