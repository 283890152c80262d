// Converts texture coordinates from the convention of other formats to that of core/mesh/attributes.h.
#pragma once

#include <array>

#include "core/math/vec3.h"

namespace lodestone {

// Texture coordinates that count from the lower left corner of the image, as in OBJ, PLY and bare Draco files.
[[nodiscard]] inline Vec2f from_lower_left(double u, double v) {
  return {static_cast<float>(u), static_cast<float>(1 - v)};
}

// The inverse, for writing them.
template <class Scalar>
[[nodiscard]] std::array<Scalar, 2> to_lower_left(Vec2f uv) {
  return {static_cast<Scalar>(uv.x), static_cast<Scalar>(1 - static_cast<double>(uv.y))};
}

}  // namespace lodestone
