#include "experiments/studies/picture_summary.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

using enum ColumnInfo::Kind;

// Largest and mean over the frames that follow another one; nothing where none does.
struct PopTotals {
  double p99 = 0, max = 0, mean = 0, changed = 0, area = 0;
};

std::optional<PopTotals> totals(const std::vector<PictureSample>& samples,
                                std::optional<ImagePops> PictureSample::*which) {
  PopTotals t;
  double frames = 0;
  for (const PictureSample& sample : samples)
    if (const auto& pops = sample.*which) {
      t.p99 = std::max(t.p99, pops->p99), t.max = std::max(t.max, pops->max), t.mean += pops->mean;
      t.changed = std::max(t.changed, pops->changed_share);
      t.area = std::max(t.area, static_cast<double>(pops->largest_changed));
      ++frames;
    }
  if (frames == 0) return {};
  t.mean /= frames;
  return t;
}

}  // namespace

std::vector<ColumnInfo> PictureSummary::columns() {
  return {
      {"image_error", "%", "difference from the full model's picture, mean over pixels and frames", accuracy},
      {"image_error_p99", "%", "difference that 99 % of a picture's pixels do not exceed, most", accuracy},
      {"psnr", "dB", "of the worst picture that differs at all", quality},
      {"ssim", "", "of the worst picture", quality},
      {"flip", "", "FLIP from the full model's picture, mean over pixels and frames", accuracy},
      {"pop_p99", "%", "change of the difference that 99 % of a picture's pixels do not exceed, most", accuracy},
      {"pop_max", "%", "largest change of the difference from one picture to the next", accuracy},
      {"pop_mean", "%", "change of the difference, mean over pixels and frames", accuracy},
      {"pop_changed", "%", "pixels whose difference changes visibly, most", accuracy},
      {"pop_area", "pixels", "largest connected part of these", accuracy},
      {"flip_pop_p99", "", "change of FLIP that 99 % of a picture's pixels do not exceed, most", accuracy},
      {"flip_pop_max", "", "largest change of FLIP from one picture to the next", accuracy},
      {"flip_pop_mean", "", "change of FLIP, mean over pixels and frames", accuracy},
      {"flip_pop_area", "pixels", "largest connected part of those whose FLIP changes visibly", accuracy},
  };
}

void PictureSummary::add_to(Row& row) const {
  if (samples_.empty()) return;
  const auto frames = static_cast<double>(samples_.size());
  double error = 0, flip = 0, p99 = 0, ssim = 1, psnr = INFINITY;
  for (const auto& [quality, pops, flip_pops] : samples_) {
    error += quality.mean_absolute / frames, flip += quality.flip.mean / frames;
    p99 = std::max(p99, quality.absolute.p99), ssim = std::min(ssim, quality.ssim), psnr = std::min(psnr, quality.psnr);
  }
  row["image_error"] = 100 * error, row["image_error_p99"] = 100 * p99, row["flip"] = flip, row["ssim"] = ssim;
  row["psnr"] = std::isfinite(psnr) ? Row(psnr) : Row();
  if (const auto t = totals(samples_, &PictureSample::pops)) {
    row["pop_p99"] = 100 * t->p99, row["pop_max"] = 100 * t->max, row["pop_mean"] = 100 * t->mean;
    row["pop_changed"] = 100 * t->changed, row["pop_area"] = t->area;
  }
  if (const auto t = totals(samples_, &PictureSample::flip_pops)) {
    row["flip_pop_p99"] = t->p99, row["flip_pop_max"] = t->max, row["flip_pop_mean"] = t->mean;
    row["flip_pop_area"] = t->area;
  }
}

void PictureSummary::check(RowVerdict& verdict) {
  for (const char* column : {"image_error", "image_error_p99", "pop_p99", "pop_max", "pop_mean", "pop_changed"})
    verdict.at_most(column, 100 + 1e-9);
  for (const char* column : {"ssim", "flip", "flip_pop_max"}) verdict.at_most(column, 1 + 1e-9);
  verdict.in_order("pop_p99", "pop_max");
  verdict.in_order("flip_pop_p99", "flip_pop_max");
}

}  // namespace lodestone
