#include "experiments/metrics/pops/jump_tracker.h"

#include <algorithm>
#include <utility>

namespace lodestone {
namespace {

double largest_limit_jump(DetailLimits before, const MorphContext& after, const Selection& whole,
                          Scheduler& scheduler) {
  if (std::ranges::equal(before, after.limits)) return 0;
  MorphContext from = after;
  from.limits = before;
  Selection selected;
  select_cells(*from.hierarchy, *from.radii, from.viewpoint, {.limits = before}, selected);
  return largest_jump(from, selected, after, whole, scheduler).max_jump;
}

}  // namespace

std::optional<PopReport> JumpTracker::follow(const MorphContext& morph, Selection whole, Scheduler& scheduler,
                                             const JumpConfig& config) {
  std::optional<PopReport> jumps;
  if (has_previous_) {
    MorphContext before = morph;
    before.viewpoint = viewpoint_;
    before.radii = &radii_;
    before.limits = limits_;
    jumps = largest_jump(before, whole_, morph, whole, scheduler, config);
    jumps->max_limit_jump = largest_limit_jump(limits_, morph, whole, scheduler);
  }
  has_previous_ = true;
  whole_ = std::move(whole);
  viewpoint_ = morph.viewpoint;
  radii_ = *morph.radii;
  limits_.assign(morph.limits.begin(), morph.limits.end());
  return jumps;
}

}  // namespace lodestone
