// The digits that float32 leaves to a model whose extent comes from a few vertices far away from all others.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Nearly all of a model within a small part of its extent.
struct CrowdedModel {
  double share = 0;  // of the longest extent: the longest side of the box of all but one vertex in a hundred
  double step = 0;   // of coordinates there, in model units
  double steps = 0;  // that side in steps: what is left of the 2^24 of a model that fills its box
  Vec3d farthest;    // the vertex farthest from the middle of that box, in model units
};

// Positions are normalised. Returns nothing if the model is at least 2^16 steps wide. Judges by a regular sample in 0.1
// ms.
[[nodiscard]] std::optional<CrowdedModel> find_crowded(std::span<const Vec3f> positions, const Transform& transform);

// A note for people, with the remedy.
[[nodiscard]] std::string describe(const CrowdedModel& model);

}  // namespace lodestone
