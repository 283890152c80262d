// What is measured of the frames of a flight beside their cost: cracks and pops of the drawn surface, and what an
// observer sees of them in the picture.
#pragma once

#include <optional>
#include <string>

#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pictures/error_map.h"
#include "experiments/metrics/pops/jump_tracker.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/picture_summary.h"
#include "experiments/studies/surface_summary.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/frame.h"
#include "render/frame/image.h"

namespace lodestone {

// The drawn surface of a morphing hierarchy, whole and before culling.
class SurfaceMeasures {
 public:
  // Of pictures of a size. The hierarchy outlives it.
  SurfaceMeasures(const Hierarchy& hierarchy, ImageSize size, Scheduler& scheduler);

  // `frame` is what the shot's camera sees.
  [[nodiscard]] SurfaceSample measure(const ModelFrame& frame, const Shot& shot);

 private:
  const Hierarchy& hierarchy_;
  ImageSize size_;
  Scheduler& scheduler_;
  CrackBasis basis_;
  CrackScratch scratch_;
  JumpTracker jumps_;
  // Draws M_L, for the silhouette that leaks of the background lie in. Of closed models alone, and of its own: what
  // leaks must not depend on which pictures are asked for, nor on what draws them.
  std::optional<ModelDrawer> full_;
};

// Pictures against those of the full model.
class PictureMeasures {
 public:
  explicit PictureMeasures(Scheduler& scheduler) : scheduler_(scheduler) {}

  [[nodiscard]] PictureSample measure(const Image& picture, Image full, const ViewProjection& view_projection,
                                      bool follows);

 private:
  struct Frame {
    Image full;
    ErrorMap absolute, flip;
    ViewProjection view_projection;
  };
  Scheduler& scheduler_;
  std::optional<Frame> previous_;
};

// The frame with the largest mean FLIP of a flight.
class WorstPicture {
 public:
  void offer(const Image& picture, const Image& full, double flip);
  // worst-drawn.png, worst-full.png, worst-flip.png; nothing where nothing was offered.
  void write(const std::string& directory, Scheduler& scheduler) const;

 private:
  Image picture_, full_;
  double flip_ = -1;
};

}  // namespace lodestone
