// A flight to look at: its worst picture, and all of them, small, beside how they differ from the full model's.
#pragma once

#include <string>
#include <vector>

#include "experiments/metrics/pictures/error_map.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/image.h"

namespace lodestone {

class FlightPictures {
 public:
  // In the order of the flight, of one size. `flip`: its mean FLIP from the full model's picture.
  void offer(const Image& picture, const Image& full, double flip);

  // worst-drawn.png, worst-full.png and worst-flip.png of the largest mean FLIP. Of several pictures also
  // differences.png, eight at most from the first to the last, and flight.webp: every picture, beside its difference.
  // Those are of pictures at most `small_width` pixels wide, and all of one scale. Nothing where nothing was offered.
  void write(const std::string& directory, Scheduler& scheduler) const;

  static constexpr int small_width = 320;

 private:
  Image worst_, worst_full_;
  double worst_flip_ = -1;
  std::vector<Image> small_;
  std::vector<ErrorMap> differences_;  // of these
};

}  // namespace lodestone
