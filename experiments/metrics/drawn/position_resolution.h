// Smallest distance that is more than rounding: positions of hierarchies, maps and progressive meshes are float32 in
// the unit cube.
#pragma once

namespace lodestone {

// By rounding alone a position there is off by up to half an ulp of a number just below 1, 2^-25, in each coordinate:
// sqrt(3) 2^-25 of the unit cube's side, and so at most of the diagonal of what lies in it. Edges are no longer than
// about 1, so that their directions are off by as many radians. Copies that went through double precision differ by
// 1e-16: that is noise, and here it is 0.
inline constexpr double position_resolution = 1.7320508075688772 / (1 << 25);

[[nodiscard]] constexpr double resolved(double length) { return length <= position_resolution ? 0 : length; }

}  // namespace lodestone
