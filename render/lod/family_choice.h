// Which families of a streamed hierarchy belong in memory: a function of the view and the budget alone, so that a
// camera at rest has one answer, whatever was in memory before and in whatever order families arrive.
//
// A family (core/hierarchy/lode/lode_payload.h), the children of cell Q of level l, is needed when d(v_p, Q) < r_l. By
// its *excess* r_l - d(v_p, Q), families are taken in until the budget is full: of one level the nearest first, at one
// distance those of the largest error. No other order wastes nothing. For if all families of an excess below s are
// missing, their limits (limits.h) amount to d' <= d + s, and any P of level m that is taken in, r_m - d(v_p, P) >= s,
// is refined nevertheless: d(v_p, Q) <= d(v_p, P) + f with f the largest distance of a point of P from Q, hence
// r_l - f <= s + d(v_p, P) <= r_m. By the ratio r_l / d, in contrast, fine families near the viewpoint would be loaded
// that the limits of coarse ones far away keep out of the picture. For the same reason a camera's direction does not
// count: what is missing behind it coarsens what is in front of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/radii.h"

namespace lodestone {

struct FamilyBudget {
  std::span<const std::uint64_t> bytes;  // of each family, by its parent
  std::uint64_t room = 0;                // bytes that all chosen ones may take
};

// Cells by their excess, the largest first: the order in which their families are chosen, loaded, and, from the end,
// removed. Parents come before their children.
[[nodiscard]] std::vector<CellId> sorted_by_excess(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint,
                                                   std::span<const CellId> cells);

// By how much the viewpoint is nearer to the cell than its radius; above 0: its children are needed. Decreases from a
// cell to its children.
[[nodiscard]] float excess(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, CellId cell);

// The families to have, by their parents; a family comes with all those above it. Where not all needed ones fit, one
// that is too large for what is left is passed over and others take its place, unless its limit would keep them out of
// the picture; the search ends after `passed_over_at_most` of these, which bounds the time of a frame.
inline constexpr std::size_t passed_over_at_most = 32;
[[nodiscard]] std::vector<CellId> choose_families(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint,
                                                  const FamilyBudget& budget);

}  // namespace lodestone
