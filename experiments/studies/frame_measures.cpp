#include "experiments/studies/frame_measures.h"

#include <utility>

#include "experiments/metrics/pictures/flip.h"

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
  Frame now{std::move(full), {}, {}, view_projection};
  now.absolute = absolute_error(now.full, picture);
  now.flip = flip_error(now.full, picture, scheduler_);
  PictureSample sample;
  ImageQualityConfig config;
  config.with_flip = false;
  sample.quality = image_quality(now.full, picture, scheduler_, config);
  sample.quality.flip = summarise(now.flip.value);
  if (follows && previous_) {
    const auto errors = [](const Frame& frame) {
      return ErrorFrame{{&frame.absolute, &frame.flip}, &frame.full, frame.view_projection};
    };
    const std::vector<ImagePops> pops = image_pops(errors(*previous_), errors(now), scheduler_);
    sample.pops = pops[0], sample.flip_pops = pops[1];
  }
  previous_ = std::move(now);
  return sample;
}

}  // namespace lodestone
