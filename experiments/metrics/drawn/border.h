// The border of a drawn surface: edges that its triangles do not run through equally often in both directions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// Ends are numbers of places, the lower one first; `vertex` is one of the vertices at each end.
struct BorderEdge {
  std::array<std::uint32_t, 2> end{}, vertex{};
};

// In ascending order. Vertices are welded by the values of their positions (-0 = +0). O(n log n).
[[nodiscard]] std::vector<BorderEdge> border_edges(std::span<const Vec3d> positions,
                                                   std::span<const Triangle> triangles);

}  // namespace lodestone
