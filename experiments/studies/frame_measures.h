// What is measured of the frames of a flight beside their cost: cracks and pops of the drawn surface, and what an
// observer sees of them in the picture.
#pragma once

#include <optional>
#include <string>

#include "experiments/metrics/cracks.h"
#include "experiments/metrics/error_map.h"
#include "experiments/metrics/jump_tracker.h"
#include "experiments/studies/picture_summary.h"
#include "experiments/studies/surface_summary.h"
#include "parallel/scheduler.h"
#include "render/frame.h"
#include "render/image.h"

namespace lodestone {

// The drawn surface of a morphing hierarchy, whole and before culling.
class SurfaceMeasures {
 public:
  // The hierarchy outlives it. Leaks are looked for where the surface is closed.
  SurfaceMeasures(const Hierarchy& hierarchy, Scheduler& scheduler);

  // `follows`: the frame measured before is a step away. `full`: the picture of the full model by the same camera, or
  // null.
  [[nodiscard]] SurfaceSample measure(const ModelFrame& frame, ImageSize size, bool follows, const Image* full);

 private:
  const Hierarchy& hierarchy_;
  Scheduler& scheduler_;
  CrackBasis basis_;
  CrackScratch scratch_;
  JumpTracker jumps_;
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
