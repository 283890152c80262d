// Steps of gratings and of pictures as the eye sees them: against direct sums, and against what the formula says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "core/base/error.h"
#include "experiments/metrics/pops/picture_pops.h"
#include "experiments/metrics/pops/step_visibility.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

using std::numbers::pi;

// r(t) by steps of equal length, where the fast one takes steps of equal ratio.
double swing_by_small_steps(double rho) {
  const auto s = [&](double omega) {
    const double v = std::max(omega / rho, 0.1), c2 = 0.7986;
    return 0.6329 * 0.8404 * c2 * (6.1 + 7.3 * std::pow(std::abs(std::log10(c2 * v / 3)), 3)) * v *
           std::pow(2 * pi * 0.8404 * rho, 2) * std::exp(-4 * pi * 0.8404 * rho * (c2 * v + 2) / 45.9);
  };
  constexpr double step = 0.01;
  double most = 0;
  for (double t = 0.005; t < 0.3; t *= 1.02) {
    double r = 0;
    for (double omega = step / 2; omega < 120; omega += step)
      r += s(omega) * std::sin(2 * pi * omega * t) / (pi * omega) * step;
    most = std::max(most, r);
  }
  return 2 * most;
}

TEST(StepSensitivity, IsThatOfTheFormula) {
  for (const double rho : {0.1, 0.5, 1.3, 3.0, 8.0, 16.0})
    EXPECT_NEAR(step_sensitivity(rho), swing_by_small_steps(rho), 0.02 * step_sensitivity(rho)) << rho;
  EXPECT_NEAR(step_sensitivity(3), 118, 1);
  EXPECT_EQ(step_sensitivity(0), step_sensitivity(0.05));
  EXPECT_EQ(step_sensitivity(60), 0);
  EXPECT_EQ(step_sensitivity(INFINITY), 0);
  for (const double wrong : {-1.0, double{NAN}}) EXPECT_THROW((void)step_sensitivity(wrong), InputError);
}

constexpr ImageSize size{48, 36};

std::vector<float> filled(const auto& at) {
  std::vector<float> values;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) values.push_back(static_cast<float>(at(x, y)));
  return values;
}

// Every frequency of the picture in an empty square, by definition.
std::vector<double> slow_visibility(const std::vector<float>& change, std::size_t columns, std::size_t rows,
                                    double ppd) {
  const auto turn = [](std::size_t k, std::size_t n) { return std::polar(1.0, -2 * pi * double(k % n) / double(n)); };
  std::vector<std::complex<double>> seen(change.size());
  const std::size_t width = 48, height = 36;
  for (std::size_t v = 0; v < rows; ++v)
    for (std::size_t u = 0; u < columns; ++u) {
      std::complex<double> sum = 0;
      for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x)
          sum += double{change[y * width + x]} * turn(u * x, columns) * turn(v * y, rows);
      const double across = double(std::min(u, columns - u)) / double(columns) * ppd,
                   down = double(std::min(v, rows - v)) / double(rows) * ppd;
      sum *= step_sensitivity(std::hypot(across, down)) / double(columns * rows);
      for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x)
          seen[y * width + x] += sum * std::conj(turn(u * x, columns) * turn(v * y, rows));
    }
  std::vector<double> all;
  for (const std::complex<double> s : seen) all.push_back(std::abs(s.real()));
  return all;
}

TEST(StepVisibility, EqualsItsSlowTwin) {
  std::mt19937 random(1);
  const std::vector<float> noise =
      filled([&](int, int) { return 0.01 * (static_cast<double>(random() % 1000) / 1000 - 0.5); });
  const std::vector<float> fast = step_visibility(noise, size, *make_serial_scheduler(), 10);
  const std::vector<double> slow = slow_visibility(noise, 60, 48, 10);  // 48 + 10 and 36 + 10, as products of 2, 3, 5
  for (std::size_t i = 0; i < fast.size(); ++i) ASSERT_NEAR(fast[i], slow[i], 1e-4) << i;
  for (const int threads : {2, 5}) EXPECT_EQ(step_visibility(noise, size, *make_tbb_scheduler(threads), 10), fast);
}

TEST(StepVisibility, OfAGratingIsItsContrastTimesTheSensitivity) {
  constexpr ImageSize wide{400, 300};
  for (const double rho : {1.0, 3.0, 6.0}) {
    std::vector<float> grating;
    for (int y = 0; y < wide.height; ++y)
      for (int x = 0; x < wide.width; ++x)
        grating.push_back(static_cast<float>(0.02 * std::sin(2 * pi * rho * x / 50)));
    const std::vector<float> seen = step_visibility(grating, wide, *make_serial_scheduler(), 50);
    float most = 0;
    for (int x = 180; x < 220; ++x) most = std::max(most, seen[static_cast<std::size_t>(150 * wide.width + x)]);
    EXPECT_NEAR(most, 0.02 * step_sensitivity(rho), 0.03 * 0.02 * step_sensitivity(rho)) << rho;
  }
}

TEST(StepVisibility, RefusesWhatIsNoPicture) {
  const std::vector<float> change(48 * 36);
  const auto serial = make_serial_scheduler();
  EXPECT_THROW((void)step_visibility(change, {48, 35}, *serial), InputError);
  for (const double ppd : {0.0, 1001.0, double{NAN}})
    EXPECT_THROW((void)step_visibility(change, size, *serial, ppd), InputError);
}

Image grey(std::uint8_t value) {
  Image image{size, std::vector<std::uint8_t>(4 * 48 * 36, value), std::vector<float>(48 * 36, 1)};
  return image;
}

TEST(ContrastError, IsThatOfLightOnTheScreen) {
  EXPECT_NEAR(contrast_error(grey(0), grey(255)).value[7], 100, 1e-3);
  EXPECT_NEAR(contrast_error(grey(255), grey(0)).value[7], -1 / 1.01, 1e-6);
  EXPECT_EQ(contrast_error(grey(90), grey(90)).value[7], 0);
  EXPECT_NEAR(contrast_error(grey(188), grey(255)).value[7], 0.4972 / 0.5128, 1e-3);  // 188: half of the light of 255
  Image other = grey(0);
  other.size = {36, 48};
  EXPECT_THROW((void)contrast_error(grey(0), other), InputError);
}

// One picture with a patch that is lighter than the model's, then one without, by the same camera.
TEST(PopTracker, TellsWhatChangedByEveryMeasure) {
  const auto serial = make_serial_scheduler();
  const auto full = std::make_shared<const Image>(grey(128));
  ViewProjection unit;
  unit.m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -0.25, 0, 0, -1, 0};
  const auto frame = [&](int step, bool flip) {
    Image picture = *full;
    for (int y = 12; y < 24; ++y)
      for (int x = 16; x < 32; ++x)
        for (int k = 0; k < 3; ++k)
          picture.rgba[static_cast<std::size_t>(4 * (y * size.width + x) + k)] = static_cast<std::uint8_t>(128 + step);
    ImageQualityConfig config;
    config.with_flip = flip;
    PictureErrors errors = picture_errors(*full, picture, *serial, config);
    return picture_frame(errors, picture, full, unit);
  };
  PopTracker pops(*serial, {.threshold = 0.1});
  EXPECT_FALSE(pops.next(frame(0, true)));
  const PicturePops none = pops.next(frame(0, true)).value();
  EXPECT_EQ(none.absolute.max + none.flip.max + none.visible.max, 0);
  const PicturePops some = pops.next(frame(40, true)).value();
  EXPECT_EQ(some.absolute.changed, 16u * 12u);
  EXPECT_NEAR(some.absolute.max, 40.0 / 255, 1e-6);
  EXPECT_GT(some.flip.max, 0.1);
  EXPECT_GT(some.visible.max, 10);
  EXPECT_GE(some.visible.changed, some.visible.largest_changed);
  EXPECT_GT(some.visible.largest_changed, 16u * 12u);
  EXPECT_FALSE(pops.next(frame(0, true), false)) << "does not follow";
  PopTracker without_flip(*serial, {.threshold = 0.1});
  EXPECT_FALSE(without_flip.next(frame(0, false)));
  const PicturePops little = without_flip.next(frame(1, false)).value();
  EXPECT_EQ(little.flip.pixels, 0u);
  EXPECT_EQ(little.absolute.changed, 0u);
  EXPECT_NEAR(little.visible.max / some.visible.max, 1.0 / 40, 0.01) << "linear in light";
}

}  // namespace
}  // namespace lodestone
