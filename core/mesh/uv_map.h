// Transforms of texture coordinates as matrices.
#pragma once

#include <array>
#include <optional>

#include "core/mesh/material.h"

namespace lodestone {

// (u, v) -> (a u + b v + x, c u + d v + y), in the order a, b, c, d, x, y.
using UvMap = std::array<double, 6>;

[[nodiscard]] UvMap map_of(const UvTransform& transform);

// The transform that follows `first` to have the effect of `whole`; empty if it skews or exceeds a float, which a
// textureInfo cannot say.
[[nodiscard]] std::optional<UvTransform> transform_after(const UvMap& first, const UvMap& whole);

}  // namespace lodestone
