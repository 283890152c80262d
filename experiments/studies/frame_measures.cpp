#include "experiments/studies/frame_measures.h"

#include <memory>
#include <utility>

#include "experiments/metrics/pictures/image_quality.h"

namespace lodestone {

SurfaceMeasures::SurfaceMeasures(const Hierarchy& hierarchy, ImageSize size, Scheduler& scheduler)
    : size_(size), proof_(hierarchy, scheduler) {
  if (proof_.closed()) full_.emplace(hierarchy, at_full_detail(view_of_model(size, 1)), "soft", scheduler);
}

SurfaceSample SurfaceMeasures::measure(const ModelFrame& frame, const Shot& shot) {
  Image full;
  ProofFrame proven{frame.morph, frame.view_projection, size_, shot.follows};
  if (full_) {
    full_->draw(shot.camera);
    full = full_->renderer().read_back();
    proven.full_depth = full.depth;
  }
  return proof_.measure(proven);
}

PictureSample PictureMeasures::measure(const Image& picture, Image full, const ViewProjection& view_projection,
                                       bool follows) {
  const auto shown = std::make_shared<const Image>(std::move(full));
  PictureErrors errors = picture_errors(*shown, picture, scheduler_);
  PictureSample sample{errors.quality, {}};
  sample.pops = pops_.next(picture_frame(errors, picture, shown, view_projection), follows);
  return sample;
}

}  // namespace lodestone
