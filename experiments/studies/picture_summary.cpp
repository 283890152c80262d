#include "experiments/studies/picture_summary.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "experiments/metrics/pictures/picture_metric.h"

namespace lodestone {
namespace {

using enum ColumnInfo::Kind;

// Largest and mean over the pairs of frames that have pixels in common; nothing where none has.
struct PopTotals {
  double p50 = 0, p99 = 0, max = 0, mean = 0, changed = 0, area = 0;
};

std::optional<PopTotals> totals(const std::vector<PictureSample>& samples, ImagePops PicturePops::*which) {
  PopTotals t;
  double pairs = 0;
  for (const PictureSample& sample : samples) {
    if (!sample.pops || ((*sample.pops).*which).pixels == 0) continue;
    const ImagePops& pops = (*sample.pops).*which;
    t.p50 = std::max(t.p50, pops.p50), t.p99 = std::max(t.p99, pops.p99), t.max = std::max(t.max, pops.max);
    t.mean += pops.mean, t.changed = std::max(t.changed, pops.changed_share);
    t.area = std::max(t.area, static_cast<double>(pops.largest_changed));
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
      const auto without = static_cast<double>(sample.pops->absolute.without_predecessor);
      const double share = without / std::max(without + static_cast<double>(sample.pops->absolute.pixels), 1.0);
      most = std::max(most.value_or(0), share);
    }
  return most;
}

// Pops by each measure, as columns PREFIX_p50 and so on.
struct PopFamily {
  std::string prefix, unit, what;  // what changes
  double scale;
  ImagePops PicturePops::*pops;
};
const std::vector<PopFamily>& pop_families() {
  static const std::vector<PopFamily> all{{"pop", "%", "the difference", 100, &PicturePops::absolute},
                                          {"flip_pop", "", "FLIP", 1, &PicturePops::flip},
                                          {"visible_pop", "thresholds", "contrast", 1, &PicturePops::visible}};
  return all;
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
  for (const auto& [prefix, unit, what, scale, pops] : pop_families())
    for (ColumnInfo column : std::vector<ColumnInfo>{
             {"_p50", unit, "change of " + what + " that half of a picture's pixels do not exceed, most", accuracy},
             {"_p99", unit, "change of " + what + " that 99 % of a picture's pixels do not exceed, most", accuracy},
             {"_max", unit, "largest change of " + what + " from one picture to the next", accuracy},
             {"_mean", unit, "change of " + what + ", mean over pixels and frames", accuracy},
             {"_changed", "%", "pixels of which " + what + " changes visibly, most", accuracy},
             {"_area", "pixels", "largest connected part of these", accuracy}}) {
      column.name = prefix + column.name;
      list.push_back(std::move(column));
    }
  list.push_back(
      {"without_predecessor", "%", "pixels that the picture before did not see, which pops leave out, most", count});
  return list;
}

void PictureSummary::add_to(Row& row) const {
  quality_.add_to(row);
  for (const PopFamily& family : pop_families()) {
    const auto t = totals(samples_, family.pops);
    if (!t) continue;
    row[family.prefix + "_p50"] = family.scale * t->p50, row[family.prefix + "_p99"] = family.scale * t->p99;
    row[family.prefix + "_max"] = family.scale * t->max, row[family.prefix + "_mean"] = family.scale * t->mean;
    row[family.prefix + "_changed"] = 100 * t->changed, row[family.prefix + "_area"] = t->area;
  }
  if (const auto share = largest_share_without_predecessor(samples_)) row["without_predecessor"] = 100 * *share;
}

void PictureSummary::check(RowVerdict& verdict) {
  QualitySummary::check(verdict);
  for (const char* column : {"pop_max", "pop_mean", "without_predecessor"}) verdict.at_most(column, 100 + 1e-9);
  verdict.at_most("flip_pop_max", 1 + 1e-9);
  for (const PopFamily& family : pop_families()) {
    verdict.at_most(family.prefix + "_changed", 100 + 1e-9);
    verdict.in_order(family.prefix + "_p50", family.prefix + "_p99");
    verdict.in_order(family.prefix + "_p99", family.prefix + "_max");
  }
}

}  // namespace lodestone
