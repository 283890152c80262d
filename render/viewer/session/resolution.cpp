#include "render/viewer/session/resolution.h"

#include <algorithm>
#include <cmath>

namespace lodestone::viewer {

// Both pixels and, at a tolerance in pixels, triangles go with the square of the scale. Down at once, up in steps and
// only with room to spare: a scale that changes all the time is seen more than one that is a little low.
void ResolutionGovernor::drawn(double scale, double milliseconds) {
  if (!(milliseconds > 0) || !(scale > 0)) return;
  const double wanted = scale * std::sqrt(target_ / milliseconds);
  const double eighths = std::floor(std::clamp(wanted, least_scale, 1.0) * 8) / 8;
  if (eighths < moving_scale_) {
    moving_scale_ = eighths;
  } else if (wanted > 1.25 * moving_scale_) {
    moving_scale_ = std::min({moving_scale_ + 0.125, eighths, 1.0});
  }
}

}  // namespace lodestone::viewer
