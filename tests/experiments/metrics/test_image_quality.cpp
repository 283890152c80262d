// Pictures against pictures: absolute difference, PSNR, SSIM and FLIP, by closed forms and by their slow twins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "experiments/metrics/pictures/flip_colour.h"
#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/metrics/pictures/ssim.h"
#include "tests/experiments/metrics/naive_images.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr ImageSize small{45, 38};
constexpr double ppd = FlipConfig{}.pixels_per_degree;

// The value that two uniform pictures have everywhere, and that they are uniform in it.
double flip_of(Rgb a, Rgb b) {
  const auto scheduler = make_serial_scheduler();
  const ErrorMap map = flip_error(uniform({24, 17}, a), uniform({24, 17}, b), *scheduler);
  for (const float v : map.value) EXPECT_NEAR(v, map.value.front(), 2e-5);
  return map.value.front();
}

// The picture with a rectangle of another one in it.
Image patched(Image image, const Image& other, int x0, int y0, int width, int height) {
  for (int y = y0; y < y0 + height; ++y)
    for (int x = x0; x < x0 + width; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(4 * (y * image.size.width + x) + c);
        image.rgba[i] = other.rgba[i];
      }
  return image;
}

// Most of what is compared agrees: at borders, in corners, in two places, in one pixel.
std::vector<std::pair<Image, Image>> nearly_equal_pictures() {
  const ImageSize size{80, 64};
  const Image a = pattern(size, 4), b = pattern(size, 9);
  return {{a, patched(a, b, 30, 25, 12, 9)},
          {a, patched(a, b, 0, 0, 3, 5)},
          {a, patched(a, b, 76, 60, 4, 4)},
          {a, patched(patched(a, b, 5, 60, 2, 2), b, 70, 1, 6, 2)},
          {uniform(size, {80, 90, 100}), patched(uniform(size, {80, 90, 100}), b, 40, 0, 1, 1)}};
}

TEST(Flip, EqualsItsSlowTwinWherePicturesDifferInPlaces) {
  const auto scheduler = make_serial_scheduler();
  for (const auto& [a, b] : nearly_equal_pictures()) {
    const ErrorMap fast = flip_error(a, b, *scheduler);
    const std::vector<double> slow = NaiveFlip(ppd)(a, b);
    for (std::size_t i = 0; i < slow.size(); ++i) ASSERT_NEAR(fast.value[i], slow[i], 2e-4) << i;
    EXPECT_GT(std::ranges::count(fast.value, 0.0f), 1000);
    EXPECT_GT(summarise(fast.value).max, 0.01);
  }
}

TEST(Flip, CubeRootsAreThose) {
  for (float t = 0.008f; t <= 10; t *= 1.0003f) {
    const double exact = std::cbrt(double{t});
    ASSERT_NEAR(flip::cube_root(t) / exact, 1, 2.5e-7) << t;
  }
}

TEST(Flip, EqualsItsSlowTwin) {
  const auto scheduler = make_serial_scheduler();
  for (const double resolution : {ppd, 30.0, 12.5})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Image a = pattern(small, seed), b = pattern(small, seed + 7);
      const ErrorMap fast = flip_error(a, b, *scheduler, {resolution});
      const std::vector<double> slow = NaiveFlip(resolution)(a, b);
      ASSERT_EQ(fast.value.size(), slow.size());
      double mean = 0;
      for (std::size_t i = 0; i < slow.size(); ++i) {
        ASSERT_NEAR(fast.value[i], slow[i], 2e-4);
        mean += slow[i] / static_cast<double>(slow.size());
      }
      EXPECT_GT(mean, 0.1);
      EXPECT_LT(mean, 0.9);
    }
}

TEST(Flip, ClosedForms) {
  const auto scheduler = make_serial_scheduler();
  const Image a = pattern(small, 3);
  for (const float v : flip_error(a, a, *scheduler).value) EXPECT_EQ(v, 0);
  // The published normalisation: the largest distance is that of green and blue.
  EXPECT_NEAR(flip_of({0, 255, 0}, {0, 0, 255}), 1, 1e-5);
  // Black and white differ by 100 in L and by nothing else.
  const double largest = std::pow(NaiveFlip::hyab(NaiveFlip::hunt_lab({0, 1, 0}), NaiveFlip::hunt_lab({0, 0, 1})), 0.7);
  EXPECT_NEAR(largest, 41.2760, 1e-3);
  const double p = std::pow(100, 0.7);
  EXPECT_NEAR(flip_of({0, 0, 0}, {255, 255, 255}), 0.95 + 0.05 * (p - 0.4 * largest) / (0.6 * largest), 1e-5);
  EXPECT_NEAR(flip_of({0, 0, 0}, {255, 255, 255}), 0.9674, 1e-4);
  // Two greys: a difference of L alone, below the bend.
  const auto lightness = [](double v) { return 116 * std::cbrt(NaiveFlip::srgb_to_linear(v / 255)) - 16; };
  EXPECT_NEAR(flip_of({100, 100, 100}, {130, 130, 130}),
              0.95 * std::pow(lightness(130) - lightness(100), 0.7) / (0.4 * largest), 1e-4);
}

TEST(Flip, IsSymmetricAndWithinItsRange) {
  const auto scheduler = make_serial_scheduler();
  const Image a = pattern(small, 1), b = pattern(small, 2);
  const ErrorMap there = flip_error(a, b, *scheduler), back = flip_error(b, a, *scheduler);
  EXPECT_EQ(there.value, back.value);
  for (const float v : there.value) EXPECT_TRUE(v >= 0 && v <= 1) << v;
}

// A line one pixel wide matters less the finer the pixels are.
TEST(Flip, DependsOnTheDistance) {
  const auto scheduler = make_serial_scheduler();
  const Image grey = uniform({61, 41}, {128, 128, 128});
  const Image line = make_image(grey.size, [](int x, int) {
    return x == 30 ? Rgb{200, 200, 200} : Rgb{128, 128, 128};
  });
  double before = 2;
  for (const double resolution : {10.0, 30.0, 67.0, 150.0}) {
    const double mean = summarise(flip_error(grey, line, *scheduler, {resolution}).value).max;
    EXPECT_LT(mean, before);
    EXPECT_GT(mean, 0);
    before = mean;
  }
}

TEST(Ssim, EqualsItsSlowTwin) {
  const auto scheduler = make_serial_scheduler();
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Image a = pattern(small, seed), b = pattern(small, seed + 5);
    EXPECT_NEAR(ssim(a, b, *scheduler), naive_ssim(a, b), 1e-9);
  }
  for (const auto& [a, b] : nearly_equal_pictures()) EXPECT_NEAR(ssim(a, b, *scheduler), naive_ssim(a, b), 1e-12);
  const Image smallest = pattern({11, 11}, 1), other = pattern({11, 11}, 2);
  EXPECT_NEAR(ssim(smallest, other, *scheduler), naive_ssim(smallest, other), 1e-9);
}

TEST(Ssim, ClosedForms) {
  const auto scheduler = make_serial_scheduler();
  const Image a = pattern(small, 2);
  EXPECT_NEAR(ssim(a, a, *scheduler), 1, 1e-12);
  // Without variance only the luminances are left.
  const double c1 = 6.5025;
  EXPECT_NEAR(ssim(uniform(small, {100, 100, 100}), uniform(small, {150, 150, 150}), *scheduler),
              (2 * 100 * 150 + c1) / (100 * 100 + 150 * 150 + c1), 1e-9);
  // A negative: equal variances, the covariance turned round.
  const Image negative = make_image(small, [&](int x, int y) {
    const std::uint8_t* c = &a.rgba[4 * static_cast<std::size_t>(y * small.width + x)];
    return Rgb{static_cast<std::uint8_t>(255 - c[0]), static_cast<std::uint8_t>(255 - c[1]),
               static_cast<std::uint8_t>(255 - c[2])};
  });
  EXPECT_LT(ssim(a, negative, *scheduler), 0);
}

TEST(AbsoluteError, CountsTheWorstColourAndNoAlpha) {
  Image a = uniform({4, 1}, {10, 20, 30}), b = a;
  b.rgba[0] = 15, b.rgba[1] = 17;  // first pixel: 5 and 3
  b.rgba[4 + 2] = 30 + 51;         // second: 51
  b.rgba[8 + 3] = 0;               // third: alpha alone
  const ErrorMap map = absolute_error(a, b);
  EXPECT_FLOAT_EQ(map.value[0], 5.0f / 255);
  EXPECT_FLOAT_EQ(map.value[1], 0.2f);
  EXPECT_EQ(map.value[2], 0);
  EXPECT_EQ(map.value[3], 0);
  const auto scheduler = make_serial_scheduler();
  const ImageQuality quality = image_quality(a, b, *scheduler, {.with_flip = false, .with_ssim = false});
  EXPECT_NEAR(quality.mean_absolute, (5 + 3 + 51) / (255.0 * 12), 1e-12);
  EXPECT_NEAR(quality.psnr, 10 * std::log10(12 * 255.0 * 255.0 / (25 + 9 + 51 * 51)), 1e-9);
  EXPECT_EQ(quality.absolute.share_above, 0.25);  // one of four above 8 / 255
  EXPECT_EQ(quality.absolute.pixels, 4u);
  EXPECT_EQ(quality.ssim, 1);
  EXPECT_EQ(quality.flip.pixels, 0u);
}

TEST(AbsoluteError, OneStepOfOneColourHasTheLargestFinitePsnr) {
  const Image a = uniform({7, 3}, {10, 20, 30});
  Image b = a;
  b.rgba[4 * 5 + 1] += 1;
  EXPECT_EQ(psnr(a, b), largest_psnr(21));
  EXPECT_DOUBLE_EQ(largest_psnr(21), 10 * std::log10(255.0 * 255.0 * 3 * 21));
}

TEST(AbsoluteError, EqualPicturesAreInfinitelyGood) {
  const auto scheduler = make_serial_scheduler();
  const Image a = pattern(small, 1);
  const ImageQuality quality = image_quality(a, a, *scheduler);
  EXPECT_EQ(quality.psnr, std::numeric_limits<double>::infinity());
  EXPECT_EQ(quality.mean_absolute, 0);
  EXPECT_EQ(quality.absolute.max, 0);
  EXPECT_EQ(quality.flip.max, 0);
  EXPECT_NEAR(quality.ssim, 1, 1e-12);
}

TEST(ErrorSummary, TakesQuantilesByCounting) {
  std::vector<float> values;
  for (int i = 200; i > 0; --i) values.push_back(static_cast<float>(i) / 256);  // 1/256 .. 200/256, mixed up
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  const ErrorSummary summary = summarise(values, 100.0 / 256);
  EXPECT_EQ(summary.p50, 100.0 / 256);
  EXPECT_EQ(summary.p99, 198.0 / 256);
  EXPECT_EQ(summary.max, 200.0 / 256);
  EXPECT_NEAR(summary.mean, 100.5 / 256, 1e-9);
  EXPECT_EQ(summary.share_above, 0.5);
  const ErrorSummary one = summarise(std::vector<float>{0.25f});
  EXPECT_EQ(one.p50, 0.25);
  EXPECT_EQ(one.p99, 0.25);
  EXPECT_EQ(summarise({}).max, 0);
}

TEST(ImageQuality, IsTheSameForAnyNumberOfWorkers) {
  const Image a = pattern({150, 110}, 1), b = pattern({150, 110}, 2);
  const auto serial = make_serial_scheduler();
  const PictureErrors expected = picture_errors(a, b, *serial);
  for (const int threads : {2, 5}) {
    const auto scheduler = make_tbb_scheduler(threads);
    const PictureErrors errors = picture_errors(a, b, *scheduler);
    EXPECT_EQ(errors.flip.value, expected.flip.value);
    EXPECT_EQ(errors.quality.ssim, expected.quality.ssim);
    EXPECT_EQ(errors.quality.flip.mean, expected.quality.flip.mean);
  }
}

TEST(ImageQuality, RefusesWhatCannotBeCompared) {
  const auto scheduler = make_serial_scheduler();
  const Image a = pattern(small, 1), other = pattern({20, 20}, 1), tiny = pattern({10, 30}, 1), none{{0, 0}, {}, {}};
  EXPECT_THROW((void)absolute_error(a, other), InputError);
  EXPECT_THROW((void)psnr(a, other), InputError);
  EXPECT_THROW((void)ssim(a, other, *scheduler), InputError);
  EXPECT_THROW((void)ssim(tiny, tiny, *scheduler), InputError);
  EXPECT_THROW((void)flip_error(a, other, *scheduler), InputError);
  EXPECT_THROW((void)absolute_error(none, none), InputError);
  for (const double resolution : {0.0, -1.0, 1001.0, std::nan("")})
    EXPECT_THROW((void)flip_error(a, a, *scheduler, {resolution}), InputError) << resolution;
}

}  // namespace
}  // namespace lodestone
