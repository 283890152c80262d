// Transforms of texture coordinates as matrices.
#pragma once

#include <array>
#include <optional>

#include "core/mesh/attributes.h"

namespace lodestone {

// (u, v) -> (a u + b v + x, c u + d v + y), in the order a, b, c, d, x, y.
using UvMap = std::array<double, 6>;

[[nodiscard]] UvMap map_of(const UvTransform& transform);

// The map that takes the corners of one triangle to those of another; empty for a triangle without area.
using PlaneTriangle = std::array<std::array<double, 2>, 3>;
[[nodiscard]] std::optional<UvMap> map_between(const PlaneTriangle& from, const PlaneTriangle& to);

// The transform that follows `first` to have the effect of `whole`; empty if it skews or exceeds a float, which a
// textureInfo cannot say.
[[nodiscard]] std::optional<UvTransform> transform_after(const UvMap& first, const UvMap& whole);

}  // namespace lodestone
