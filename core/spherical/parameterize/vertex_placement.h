// The direction that a new vertex starts at: inside the kernel of its ring, next to the vertex that it was split from.
#pragma once

#include <cstdint>
#include <span>

#include "core/math/lanes/double4.h"
#include "core/progressive/collapse/ring.h"

namespace lodestone::spherical {

// Along the bisector of the two half-planes that the edges to the vertices beside the target allow, half-way to the
// first plane of the ring (praun2003). All triangles of the vertex are positively oriented then, exactly. False if no
// such direction was found.
[[nodiscard]] bool place_vertex(progressive::Id vertex, progressive::Id target, const progressive::Ring& ring,
                                std::span<AlignedPoint4d> directions);

// The lowest colour that no neighbour has; absent_colour if none is left.
inline constexpr std::uint8_t absent_colour = 255;
[[nodiscard]] std::uint8_t free_colour(const progressive::Ring& ring, std::span<const std::uint8_t> colours);

}  // namespace lodestone::spherical
