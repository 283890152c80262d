// Jumps of points that a system of patches places anew for each frame.
#pragma once

#include <vector>

#include "experiments/metrics/drawn/screen.h"
#include "experiments/subjects/frame_proof.h"

namespace lodestone {

struct PlacedFrame {
  std::vector<Vec3f> places;  // of the same points in all frames
  Vec3f viewpoint;            // in the same space
};

// Ways of the points from one frame to the next, as JumpSample has those of vertices; without a bound, as none is
// known. `screen` is that of the later frame.
[[nodiscard]] JumpSample place_jumps(const PlacedFrame& before, const PlacedFrame& after, const Screen& screen);

}  // namespace lodestone
