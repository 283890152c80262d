// The pictures of a flight against those of the full model, as columns: the same for every system.
#pragma once

#include <optional>
#include <vector>

#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/metrics/pops/picture_pops.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/verdict.h"

namespace lodestone {

struct PictureSample {
  ImageQuality quality;
  std::optional<PicturePops> pops;  // where it follows the frame before
};

// Pictures one by one, as columns.
class QualitySummary {
 public:
  void add(ImageQuality quality) { samples_.push_back(std::move(quality)); }

  [[nodiscard]] static std::vector<ColumnInfo> columns();
  // Nothing where nothing was added.
  void add_to(Row& row) const;
  static void check(RowVerdict& verdict);

 private:
  std::vector<ImageQuality> samples_;
};

// And what changes from one to the next.
class PictureSummary {
 public:
  void add(PictureSample sample) {
    quality_.add(sample.quality);
    samples_.push_back(std::move(sample));
  }

  [[nodiscard]] static std::vector<ColumnInfo> columns();
  void add_to(Row& row) const;
  static void check(RowVerdict& verdict);

 private:
  QualitySummary quality_;
  std::vector<PictureSample> samples_;
};

}  // namespace lodestone
