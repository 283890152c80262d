// Adversarial viewpoints: where cracks open first when the radii are not admissible.
//
// Take a cell Q of level l, a vertex u that it shares with another cell of the level, and z, the corner of B(Q)
// farthest from u. The viewpoint lies on the ray from u through z, beyond z by r_l but for a hair, so that Q is about
// to be exchanged for its children while u is farther off than Q by its whole reach: d(v_p, u) = r_l + d(u, z). As soon
// as that is r_{l-1} or more (uniform rule: kappa0 <= d(u, z) / h_l), a cell of level l has its vertex at P(u) and the
// children of a refined one at u. The hair decides on which of the two sides Q is: on the other one than a cell that
// shares u. Random viewpoints hardly ever come near this; sweeps below the admissible border need it.
//
// With adaptive radii the pair that matters is a cell Q and another cell's parent P, which share u: the viewpoint lies
// R_Q beyond the corner of B(Q) that is farthest from B(P), on the way from B(P). Q is about to be exchanged, and P is
// R_Q + H(Q, P) away: not refined, once its radius is no larger than that.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/radii.h"

namespace lodestone {

struct AdversarialView {
  Vec3f viewpoint;       // normalised model space
  Vec3f across;          // a viewpoint on the other side of the exchange of Q
  int level = 0;         // l
  CellId cell;           // Q
  CellId other;          // a cell of the level that shares u; refined iff Q is not
  VertexId vertex;       // u, in Q
  bool refined = false;  // true if Q is refined, seen from `viewpoint`
  float reach = 0;       // d(u, z) / h_l, at most the level's reach; adaptive: (R_Q + H) / R_P, below 1 if admissible
};

struct AdversaryConfig {
  // Views, at most one per cell: as many of every level as there are, the best ones by reach; where a level has few,
  // the others give more. Fewer only where the hierarchy has no more cells with one.
  std::size_t count = 12;
  // Distance of the viewpoint from r_l, relative to r_l: more than rounding (1e-6), less than the relative distance
  // from the admissible border at which cracks are to be shown.
  float slack = 1e-5f;
};

// Views of levels 1..L-1 in this order, best first within a level; only vertices with P(u) != u are considered. A
// surface within one cell, or L < 2, has none.
[[nodiscard]] std::vector<AdversarialView> adversarial_views(const Hierarchy& hierarchy, const Radii& radii,
                                                             const AdversaryConfig& config = {});
// Why there are none.
[[nodiscard]] std::string why_no_adversary(const Hierarchy& hierarchy);

}  // namespace lodestone
