#include "experiments/studies/picture_summary.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "experiments/metrics/pictures/picture_metric.h"

namespace lodestone {
namespace {

using enum ColumnInfo::Kind;

using Pops = std::optional<ImagePops> PictureSample::*;

// Largest and mean over the pairs of frames that have pixels in common; nothing where none has.
struct PopTotals {
  double p50 = 0, p99 = 0, max = 0, mean = 0, changed = 0, area = 0;
};

std::optional<PopTotals> totals(const std::vector<PictureSample>& samples, Pops which) {
  PopTotals t;
  double pairs = 0;
  for (const PictureSample& sample : samples) {
    const auto& pops = sample.*which;
    if (!pops || pops->pixels == 0) continue;
    t.p50 = std::max(t.p50, pops->p50), t.p99 = std::max(t.p99, pops->p99), t.max = std::max(t.max, pops->max);
    t.mean += pops->mean, t.changed = std::max(t.changed, pops->changed_share);
    t.area = std::max(t.area, static_cast<double>(pops->largest_changed));
    ++pairs;
  }
  if (pairs == 0) return {};
  t.mean /= pairs;
  return t;
}

// Largest share over all pairs of frames, those without a pixel in common included.
std::optional<double> largest_share_without_predecessor(const std::vector<PictureSample>& samples) {
  std::optional<double> most;
  for (const PictureSample& sample : samples)
    if (sample.pops) {
      const auto without = static_cast<double>(sample.pops->without_predecessor);
      const double share = without / std::max(without + static_cast<double>(sample.pops->pixels), 1.0);
      most = std::max(most.value_or(0), share);
    }
  return most;
}

// Metrics of a user's own.
void add_added(Row& row, const std::vector<ImageQuality>& samples) {
  const std::vector<std::string> names = picture_metric_names();
  for (std::size_t k = 0; k < names.size() && k < samples.front().added.size(); ++k) {
    const bool more = picture_metric(names[k]).more_is_better;
    double sum = 0, worst = samples.front().added[k];
    for (const ImageQuality& quality : samples) {
      sum += quality.added[k];
      worst = more ? std::min(worst, quality.added[k]) : std::max(worst, quality.added[k]);
    }
    row["metric_" + names[k]] = sum / static_cast<double>(samples.size());
    row["metric_" + names[k] + "_worst"] = worst;
  }
}

}  // namespace

std::vector<ColumnInfo> QualitySummary::columns() {
  std::vector<ColumnInfo> list{
      {"image_error", "%", "difference from the full model's picture, mean over pixels and frames", accuracy},
      {"image_error_worst", "%", "the same of the worst picture, mean over its pixels", accuracy},
      {"image_error_p99", "%", "difference that 99 % of a picture's pixels do not exceed, most", accuracy},
      {"psnr", "dB", "of the worst picture; where all are equal at least this: as if one colour of one pixel differed",
       quality},
      {"ssim", "", "of the worst picture", quality},
      {"flip", "", "FLIP from the full model's picture, mean over pixels and frames", accuracy},
      {"flip_worst", "", "the same of the worst picture, mean over its pixels", accuracy},
  };
  for (const std::string& name : picture_metric_names()) {
    const PictureMetric& metric = picture_metric(name);
    const ColumnInfo::Kind kind = metric.more_is_better ? quality : accuracy;
    list.push_back({"metric_" + name, metric.unit, metric.meaning + ", mean over frames", kind});
    list.push_back({"metric_" + name + "_worst", metric.unit, "the same of the worst picture", kind});
  }
  return list;
}

void QualitySummary::add_to(Row& row) const {
  if (samples_.empty()) return;
  double error = 0, worst_error = 0, p99 = 0, psnr = INFINITY, ssim = 1, flip = 0, worst_flip = 0;
  for (const ImageQuality& quality : samples_) {
    error += quality.mean_absolute, worst_error = std::max(worst_error, quality.mean_absolute);
    flip += quality.flip.mean, worst_flip = std::max(worst_flip, quality.flip.mean);
    p99 = std::max(p99, quality.absolute.p99), ssim = std::min(ssim, quality.ssim);
    psnr = std::min({psnr, quality.psnr, largest_psnr(quality.absolute.pixels)});
  }
  const auto frames = static_cast<double>(samples_.size());
  row["image_error"] = 100 * error / frames, row["image_error_worst"] = 100 * worst_error;
  row["image_error_p99"] = 100 * p99, row["ssim"] = ssim;
  row["psnr"] = psnr;
  row["flip"] = flip / frames, row["flip_worst"] = worst_flip;
  add_added(row, samples_);
}

void QualitySummary::check(RowVerdict& verdict) {
  verdict.in_order("image_error", "image_error_worst");
  verdict.in_order("flip", "flip_worst");
  for (const char* column : {"image_error_worst", "image_error_p99"}) verdict.at_most(column, 100 + 1e-9);
  for (const char* column : {"ssim", "flip_worst"}) verdict.at_most(column, 1 + 1e-9);
}

std::vector<ColumnInfo> PictureSummary::columns() {
  std::vector<ColumnInfo> list = QualitySummary::columns();
  const std::vector<ColumnInfo> pops{
      {"pop_p50", "%", "change of the difference that half of a picture's pixels do not exceed, most", accuracy},
      {"pop_p99", "%", "change of the difference that 99 % of a picture's pixels do not exceed, most", accuracy},
      {"pop_max", "%", "largest change of the difference from one picture to the next", accuracy},
      {"pop_mean", "%", "change of the difference, mean over pixels and frames", accuracy},
      {"pop_changed", "%", "pixels whose difference changes visibly, most", accuracy},
      {"pop_area", "pixels", "largest connected part of these", accuracy},
      {"without_predecessor", "%", "pixels that the picture before did not see, which pops leave out, most", count},
      {"flip_pop_p50", "", "change of FLIP that half of a picture's pixels do not exceed, most", accuracy},
      {"flip_pop_p99", "", "change of FLIP that 99 % of a picture's pixels do not exceed, most", accuracy},
      {"flip_pop_max", "", "largest change of FLIP from one picture to the next", accuracy},
      {"flip_pop_mean", "", "change of FLIP, mean over pixels and frames", accuracy},
      {"flip_pop_changed", "%", "pixels whose FLIP changes visibly, most", accuracy},
      {"flip_pop_area", "pixels", "largest connected part of these", accuracy},
  };
  list.insert(list.end(), pops.begin(), pops.end());
  return list;
}

void PictureSummary::add_to(Row& row) const {
  quality_.add_to(row);
  if (const auto t = totals(samples_, &PictureSample::pops)) {
    row["pop_p50"] = 100 * t->p50;
    row["pop_p99"] = 100 * t->p99, row["pop_max"] = 100 * t->max, row["pop_mean"] = 100 * t->mean;
    row["pop_changed"] = 100 * t->changed, row["pop_area"] = t->area;
  }
  if (const auto t = totals(samples_, &PictureSample::flip_pops)) {
    row["flip_pop_p50"] = t->p50;
    row["flip_pop_p99"] = t->p99, row["flip_pop_max"] = t->max, row["flip_pop_mean"] = t->mean;
    row["flip_pop_changed"] = 100 * t->changed, row["flip_pop_area"] = t->area;
  }
  if (const auto share = largest_share_without_predecessor(samples_)) row["without_predecessor"] = 100 * *share;
}

void PictureSummary::check(RowVerdict& verdict) {
  QualitySummary::check(verdict);
  for (const char* column : {"pop_max", "pop_mean", "pop_changed", "flip_pop_changed", "without_predecessor"})
    verdict.at_most(column, 100 + 1e-9);
  verdict.at_most("flip_pop_max", 1 + 1e-9);
  verdict.in_order("pop_p50", "pop_p99");
  verdict.in_order("pop_p99", "pop_max");
  verdict.in_order("flip_pop_p50", "flip_pop_p99");
  verdict.in_order("flip_pop_p99", "flip_pop_max");
}

}  // namespace lodestone
