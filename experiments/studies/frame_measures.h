// Measures of the frames of a flight beside their cost: cracks and pops of the drawn surface, and what an
// observer sees of them in the picture.
#pragma once

#include <optional>

#include "experiments/metrics/pops/picture_pops.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/picture_summary.h"
#include "experiments/subjects/frame_proof.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/frame.h"
#include "render/frame/image.h"

namespace lodestone {

// The proof of a model's frames as a drawer shows them, leaks of a closed model included.
class SurfaceMeasures {
 public:
  // For pictures of this size. The hierarchy outlives it.
  SurfaceMeasures(const Hierarchy& hierarchy, ImageSize size, Scheduler& scheduler);

  // `frame` is what the shot's camera sees.
  [[nodiscard]] SurfaceSample measure(const ModelFrame& frame, const Shot& shot);

 private:
  ImageSize size_;
  FrameProof proof_;
  // Draws M_L, for the silhouette that leaks of the background lie in. Only for closed models, and with a renderer of
  // its own: what leaks must not depend on which pictures are asked for, nor on what draws them.
  std::optional<ModelDrawer> full_;
};

// Pictures against those of the full model.
class PictureMeasures {
 public:
  explicit PictureMeasures(Scheduler& scheduler) : scheduler_(scheduler), pops_(scheduler) {}

  [[nodiscard]] PictureSample measure(const Image& picture, Image full, const ViewProjection& view_projection,
                                      bool follows);

 private:
  Scheduler& scheduler_;
  PopTracker pops_;
};

}  // namespace lodestone
