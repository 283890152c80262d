// LOD systems that are compared: what each draws of one hierarchy for the same radii. They differ in nothing else.
//
// All but `cross_fade` are the usual selection and morph with other numbers: bands that begin beyond everything leave
// every vertex where its own level has it, radii of 0 and infinity select one level as a whole.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/radii.h"

namespace lodestone {

enum class LodSystem : std::uint8_t {
  morph,       // this program's: cells by distance, vertices morphed
  step,        // the same with the blend `step`: vertices jump in the middle of the band, but nothing cracks
  discrete,    // cells by distance, each at the level that the distance chooses, no morph: it pops, and cracks
  cross_fade,  // the whole model at one level; two pictures blended while levels change: no cracks, ghosts
  full,        // M_L: what the others are measured against
};

[[nodiscard]] LodSystem lod_system(std::string_view name);  // throws InputError listing the known names
[[nodiscard]] std::string_view name_of(LodSystem system);
[[nodiscard]] std::span<const LodSystem> all_lod_systems();

// The same selection, lambda = 1 everywhere. jump_bounds() of such radii has no bound.
[[nodiscard]] Radii without_morph(const Radii& radii);

// Selects all cells of a level, lambda = 1 everywhere.
[[nodiscard]] Radii whole_level(const Radii& radii, int level);

// The levels of the whole model that are seen: `share` of the coarse one and 1 - share of the fine one; one level when
// they are equal.
struct CrossFade {
  int fine = 0, coarse = 0;
  double share = 0;
  friend bool operator==(const CrossFade&, const CrossFade&) = default;
};

// A level l is good enough when (2) holds for the box of the whole model, d(v_p, B(root)) >= r_l. The coarsest one that
// is appears gradually between r_l and (1 + width) r_l, or r_{l-1} if that is nearer; so what is seen is continuous in
// the viewpoint. width >= 0; 0: it appears at once.
[[nodiscard]] CrossFade cross_fade(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, double width);

}  // namespace lodestone
