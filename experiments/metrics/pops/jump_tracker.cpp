#include "experiments/metrics/pops/jump_tracker.h"

#include <utility>

namespace lodestone {

std::optional<PopReport> JumpTracker::follow(const MorphContext& morph, Selection whole, Scheduler& scheduler,
                                             const JumpConfig& config) {
  std::optional<PopReport> jumps;
  if (has_previous_) {
    MorphContext before = morph;
    before.viewpoint = viewpoint_;
    before.radii = &radii_;
    before.limits = limits_;
    jumps = largest_jump(before, whole_, morph, whole, scheduler, config);
  }
  has_previous_ = true;
  whole_ = std::move(whole);
  viewpoint_ = morph.viewpoint;
  radii_ = *morph.radii;
  limits_.assign(morph.limits.begin(), morph.limits.end());
  return jumps;
}

}  // namespace lodestone
