// Adversarial viewpoints: where cracks open first when the radii are not admissible.
//
// Take a cell Q of level l, a vertex u that it shares with another cell of the level, and z, the corner of B(Q)
// farthest from u. The viewpoint stands on the ray from u through z, beyond z by just less than r_l. Then Q is refined
// by a hair, and u is farther off than Q by its whole reach: d(v_p, u) = r_l + d(u, z). The children of Q stand at
// their parent's place, u; a cell on the far side that shares u is not refined and stands at P(u) as soon as d(v_p, u)
// >= r_{l-1}, for the uniform rule as soon as kappa0 <= d(u, z) / h_l. Random viewpoints hardly ever come near this;
// sweeps below the admissible border need it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/hierarchy.h"
#include "render/lod/radii.h"

namespace lodestone {

struct AdversarialView {
  Vec3f viewpoint;           // normalised model space
  int level = 0;             // l
  std::uint32_t cell = 0;    // Q, refined
  std::uint32_t other = 0;   // a cell that shares u and is not refined
  std::uint32_t vertex = 0;  // u, index in Q
  float reach = 0;           // d(u, z) / h_l: at most the level's reach
};

struct AdversaryConfig {
  std::size_t per_level = 4;  // views per level: the best ones by reach, at most one per cell
  // How far inside r_l the viewpoint stands, relative to r_l; negative: outside, so that Q is not refined. Smaller than
  // the distance from the admissible border that is to be shown, larger than float rounding (1e-6).
  float slack = 1e-5f;
};

// Views of levels 1..L-1, best first within a level. Only vertices with P(u) != u that some unrefined cell shares are
// considered, so a surface within one cell, or L < 2, has none.
[[nodiscard]] std::vector<AdversarialView> adversarial_views(const Hierarchy& hierarchy, const Radii& radii,
                                                             const AdversaryConfig& config = {});

}  // namespace lodestone
