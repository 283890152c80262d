// Jumps from frame to frame of a flight: pops.h with the frame before kept.
#pragma once

#include <optional>
#include <vector>

#include "experiments/metrics/pops/pops.h"

namespace lodestone {

class JumpTracker {
 public:
  // From the frame given before to this one; none for the first. `whole`: the partition that `morph` selects, nothing
  // culled. The hierarchy, the blend and the metric are those of the frame before, and the hierarchy outlives the call.
  [[nodiscard]] std::optional<PopReport> follow(const MorphContext& morph, Selection whole, Scheduler& scheduler,
                                                const JumpConfig& config = {});
  // The next frame does not continue the one before.
  void forget() { has_previous_ = false; }

 private:
  bool has_previous_ = false;
  Selection whole_;
  Vec3f viewpoint_;
  Radii radii_;
  std::vector<DetailLimit> limits_;
};

}  // namespace lodestone
