#include "experiments/metrics/pops/picture_pops.h"

#include <algorithm>
#include <utility>

#include "experiments/metrics/pops/step_visibility.h"

namespace lodestone {
namespace {

ErrorFrame errors_of(const PictureFrame& frame) {
  ErrorFrame errors{{&frame.absolute, &frame.contrast}, frame.full.get(), frame.view_projection};
  if (!frame.flip.value.empty()) errors.errors.push_back(&frame.flip);
  return errors;
}

// Pixels without a predecessor are taken as unchanged, and left out afterwards.
ImagePops visible_pops(std::vector<float> change, ImageSize size, Scheduler& scheduler) {
  std::vector<float> known = change;
  std::ranges::replace(known, no_predecessor, 0.0f);
  const std::vector<float> visibility = step_visibility(known, size, scheduler);
  for (std::size_t i = 0; i < change.size(); ++i)
    if (change[i] != no_predecessor) change[i] = visibility[i];
  return summarise_pops(change, size, 1);
}

}  // namespace

PictureFrame picture_frame(PictureErrors& errors, const Image& picture, std::shared_ptr<const Image> full,
                           const ViewProjection& view_projection) {
  ErrorMap contrast = contrast_error(*full, picture);
  return {std::move(errors.absolute), std::move(errors.flip), std::move(contrast), std::move(full), view_projection};
}

std::optional<PicturePops> PopTracker::next(PictureFrame frame, bool follows) {
  const std::optional<PictureFrame> before = std::exchange(before_, std::move(frame));
  if (!before || !follows) return {};
  const ImageSize size = before_->full->size;
  std::vector<std::vector<float>> changes = change_maps(errors_of(*before), errors_of(*before_), *scheduler_, config_);
  PicturePops pops;
  pops.absolute = summarise_pops(changes[0], size, config_.threshold);
  pops.visible = visible_pops(std::move(changes[1]), size, *scheduler_);
  if (changes.size() > 2) pops.flip = summarise_pops(changes[2], size, config_.threshold);
  return pops;
}

}  // namespace lodestone
