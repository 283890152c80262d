// The pops of the pictures of a flight, one after the other, by every measure.
#pragma once

#include <memory>
#include <optional>

#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/metrics/pops/image_pops.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"

namespace lodestone {

// Since the frame before.
struct PicturePops {
  ImagePops absolute;  // of the largest difference of red, green or blue
  ImagePops flip;      // of FLIP; without pixels where that is not measured
  ImagePops visible;   // in thresholds of the eye (step_visibility.h), those above 1 counted
};

// A picture against the full model's by the same camera, which has depth.
struct PictureFrame {
  ErrorMap absolute, flip, contrast;  // the second may be empty
  std::shared_ptr<const Image> full;
  ViewProjection view_projection;
};

// The maps are taken from `errors`, which are those of the picture against `full`.
[[nodiscard]] PictureFrame picture_frame(PictureErrors& errors, const Image& picture, std::shared_ptr<const Image> full,
                                         const ViewProjection& view_projection);

class PopTracker {
 public:
  // FLIP is counted from config.threshold on, as absolute differences are.
  explicit PopTracker(Scheduler& scheduler, const ImagePopConfig& config = {})
      : scheduler_(&scheduler), config_(config) {}

  // Nothing for the first frame, nor for one that does not follow the one before. Throws as change_maps() does.
  [[nodiscard]] std::optional<PicturePops> next(PictureFrame frame, bool follows = true);

 private:
  Scheduler* scheduler_;
  ImagePopConfig config_;
  std::optional<PictureFrame> before_;
};

}  // namespace lodestone
