// Columns of the pictures of a flight, and of what changes from one to the next.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "experiments/studies/picture_summary.h"

namespace lodestone {
namespace {

ImageQuality picture(double mean, double p99, double psnr, double ssim, double flip) {
  ImageQuality quality;
  quality.mean_absolute = mean, quality.absolute.p99 = p99, quality.absolute.pixels = 100;
  quality.psnr = psnr, quality.ssim = ssim, quality.flip.mean = flip;
  return quality;
}

TEST(QualitySummary, AveragesErrorsAndTellsTheWorstPicture) {
  QualitySummary summary;
  Row row = Row::object();
  summary.add_to(row);
  EXPECT_TRUE(row.empty());
  summary.add(picture(0.01, 0.2, 40, 0.9, 0.25));
  summary.add(picture(0.03, 0.1, 30, 0.95, 0.125));
  summary.add_to(row);
  const std::vector<std::pair<const char*, double>> expected{
      {"image_error", 2}, {"image_error_worst", 3}, {"image_error_p99", 20}, {"psnr", 30},
      {"ssim", 0.9},      {"flip", 0.1875},         {"flip_worst", 0.25}};
  for (const auto& [column, value] : expected) EXPECT_DOUBLE_EQ(row.at(column).get<double>(), value) << column;
  EXPECT_EQ(row.size(), QualitySummary::columns().size());
}

TEST(PictureSummary, TakesPopsOfPairsThatHavePixelsInCommon) {
  const auto expect = [](const std::vector<PictureSample>& samples, const Row& expected) {
    PictureSummary summary;
    for (const PictureSample& sample : samples) summary.add(sample);
    Row row = Row::object();
    summary.add_to(row);
    for (const auto& [column, value] : expected.items()) {
      ASSERT_EQ(row.contains(column), !value.is_null()) << column;
      if (row.contains(column)) {
        EXPECT_DOUBLE_EQ(row.at(column).get<double>(), value.get<double>()) << column;
      }
    }
  };
  const PictureSample first{picture(0.01, 0.2, 40, 0.9, 0.25), {}};
  PictureSample second = first, third = first, apart = first;
  second.pops = PicturePops{{0.01, 0.1, 0.5, 0.02, 0.25, 20, 15, 80, 20},
                            {0.02, 0.3, 0.4, 0.05, 0.5, 40, 30, 80, 20},
                            {0.5, 2, 3, 0.75, 0.125, 10, 5, 80, 20}};
  third.pops = PicturePops{{0.03, 0.05, 0.25, 0.04, 0.125, 10, 7, 90, 10},
                           {0.01, 0.2, 0.6, 0.01, 0.25, 20, 10, 90, 10},
                           {0.25, 1, 4, 0.25, 0.0625, 5, 3, 90, 10}};
  constexpr ImagePops nothing{.without_predecessor = 100};
  apart.pops = PicturePops{nothing, nothing, nothing};
  const Row both = {{"image_error", 1.0},
                    {"flip", 0.25},
                    {"pop_p50", 3.0},
                    {"pop_p99", 10.0},
                    {"pop_max", 50.0},
                    {"pop_mean", 3.0},
                    {"pop_changed", 25.0},
                    {"pop_area", 15.0},
                    {"without_predecessor", 20.0},
                    {"flip_pop_p50", 0.02},
                    {"flip_pop_p99", 0.3},
                    {"flip_pop_max", 0.6},
                    {"flip_pop_mean", 0.03},
                    {"flip_pop_changed", 50.0},
                    {"flip_pop_area", 30.0},
                    {"visible_pop_p50", 0.5},
                    {"visible_pop_p99", 2.0},
                    {"visible_pop_max", 4.0},
                    {"visible_pop_mean", 0.5},
                    {"visible_pop_changed", 12.5},
                    {"visible_pop_area", 5.0}};
  expect({first, second, third}, both);
  Row without = both;
  without["without_predecessor"] = 100.0;
  expect({first, second, third, apart}, without);
  expect({first, apart}, {{"flip", 0.25},
                          {"pop_mean", Row()},
                          {"flip_pop_p99", Row()},
                          {"visible_pop_max", Row()},
                          {"without_predecessor", 100.0}});
  expect({first}, {{"flip", 0.25}, {"pop_mean", Row()}, {"without_predecessor", Row()}});
}

TEST(QualitySummary, OfEqualPicturesThePsnrIsTheLargestFiniteOne) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto psnr_of = [](std::vector<ImageQuality> pictures) {
    QualitySummary summary;
    for (const ImageQuality& quality : pictures) summary.add(quality);
    Row row;
    summary.add_to(row);
    return row.at("psnr").get<double>();
  };
  const ImageQuality equal = picture(0, 0, infinite, 1, 0);
  EXPECT_DOUBLE_EQ(psnr_of({equal, equal}), 10 * std::log10(255.0 * 255.0 * 3 * 100));
  EXPECT_EQ(psnr_of({equal, picture(0.01, 0.2, 40, 0.9, 0.25)}), 40);
}

}  // namespace
}  // namespace lodestone
