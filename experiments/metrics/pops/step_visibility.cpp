#include "experiments/metrics/pops/step_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "core/base/error.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

using std::numbers::pi;

constexpr double lowest_frequency = 0.05, highest_frequency = 60, slowest = 0.1;  // of S
constexpr double light_of_the_room = 0.01;

double sensitivity(double rho, double velocity) {
  constexpr double c0 = 0.6329, c1 = 0.8404, c2 = 0.7986;
  const double v = std::max(velocity, slowest), bend = std::abs(std::log10(c2 * v / 3));
  return c0 * c1 * c2 * (6.1 + 7.3 * bend * bend * bend) * v * std::pow(2 * pi * c1 * rho, 2) *
         std::exp(-4 * pi * c1 * rho * (c2 * v + 2) / 45.9);
}

// Sums over steps of equal ratio; what is left out at either end is below a thousandth.
double swing(double rho) {
  constexpr int frequencies = 700, times = 120;
  constexpr double lowest = 1e-4, ratio = 7.0 / frequencies, soonest = 1e-3, later = 3.0 / times;
  std::array<double, frequencies> omega{}, weight{};
  for (int k = 0; k < frequencies; ++k) {
    const auto i = static_cast<std::size_t>(k);
    omega[i] = lowest * std::pow(10, ratio * (k + 0.5));
    weight[i] = sensitivity(rho, omega[i] / rho) * ratio * std::numbers::ln10 / pi;
  }
  double most = 0;
  for (int k = 0; k <= times; ++k) {
    const double t = soonest * std::pow(10, later * k);
    double r = 0;
    for (std::size_t i = 0; i < omega.size(); ++i) r += weight[i] * std::sin(2 * pi * omega[i] * t);
    most = std::max(most, r);
  }
  return 2 * most;
}

// A at frequencies of equal ratio, made when it is first asked for.
const std::vector<double>& swings() {
  static const std::vector<double> table = [] {
    constexpr int steps = 80;
    std::vector<double> made;
    for (int k = 0; k <= steps; ++k)
      made.push_back(swing(lowest_frequency * std::pow(highest_frequency / lowest_frequency, double{1} * k / steps)));
    return made;
  }();
  return table;
}

// The next size that is a product of 2, 3 and 5, which transforms are quick for.
std::size_t quick_size(std::size_t least) {
  for (std::size_t n = least;; ++n) {
    std::size_t rest = n;
    for (const std::size_t factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
}

// A picture with a margin, so that nothing is filtered into its opposite side.
class Spectrum {
 public:
  using Complex = std::complex<double>;

  Spectrum(std::span<const float> picture, ImageSize size, double pixels_per_degree, Scheduler& scheduler)
      : width_(static_cast<std::size_t>(size.width)),
        height_(static_cast<std::size_t>(size.height)),
        pixels_per_degree_(pixels_per_degree),
        scheduler_(scheduler) {
    const auto margin = static_cast<std::size_t>(std::ceil(pixels_per_degree));
    columns_ = quick_size(width_ + margin), rows_ = quick_size(height_ + margin);
    values_.resize(columns_ * rows_);
    for (std::size_t y = 0; y < height_; ++y)
      std::copy_n(picture.begin() + static_cast<std::ptrdiff_t>(y * width_), width_, row(y));
  }

  // Multiplies each frequency by A. Rows of the margin are 0 before, and not asked for after.
  [[nodiscard]] std::vector<float> filtered() {
    std::vector<float> out(width_ * height_);
    in_chunks(height_, [&](Transform& transform, std::size_t y) { transform.forward(row(y), columns_); });
    in_chunks(columns_, [&](Transform& transform, std::size_t x) {
      std::vector<Complex> column(rows_);
      for (std::size_t y = 0; y < height_; ++y) column[y] = row(y)[x];
      transform.forward(column.data(), rows_);
      const double across = frequency(x, columns_);
      for (std::size_t y = 0; y < rows_; ++y) column[y] *= step_sensitivity(std::hypot(across, frequency(y, rows_)));
      transform.inverse(column.data(), rows_);
      for (std::size_t y = 0; y < height_; ++y) row(y)[x] = column[y];
    });
    in_chunks(height_, [&](Transform& transform, std::size_t y) {
      transform.inverse(row(y), columns_);
      for (std::size_t x = 0; x < width_; ++x) out[y * width_ + x] = static_cast<float>(std::abs(row(y)[x].real()));
    });
    return out;
  }

 private:
  struct Transform {
    Eigen::FFT<double> plan;
    std::vector<Complex> result;

    void forward(Complex* values, std::size_t count) {
      result.resize(count);
      plan.fwd(result.data(), values, static_cast<Eigen::Index>(count));
      std::ranges::copy(result, values);
    }
    void inverse(Complex* values, std::size_t count) {
      result.resize(count);
      plan.inv(result.data(), values, static_cast<Eigen::Index>(count));
      std::ranges::copy(result, values);
    }
  };

  [[nodiscard]] Complex* row(std::size_t y) { return values_.data() + y * columns_; }
  [[nodiscard]] double frequency(std::size_t k, std::size_t count) const {
    return static_cast<double>(std::min(k, count - k)) / static_cast<double>(count) * pixels_per_degree_;
  }
  template <class Use>
  void in_chunks(std::size_t count, const Use& use) {
    scheduler_.for_chunks(count, 32, [&](ChunkRange range) {
      Transform transform;
      for (std::size_t k = range.begin; k < range.end; ++k) use(transform, k);
    });
  }

  std::size_t width_, height_, columns_ = 0, rows_ = 0;
  double pixels_per_degree_;
  Scheduler& scheduler_;
  std::vector<Complex> values_;
};

}  // namespace

double step_sensitivity(double cycles_per_degree) {
  if (!(cycles_per_degree >= 0)) throw InputError("a spatial frequency is at least 0");
  if (cycles_per_degree >= highest_frequency) return 0;
  const std::vector<double>& table = swings();
  const double place = std::log(std::max(cycles_per_degree, lowest_frequency) / lowest_frequency) /
                       std::log(highest_frequency / lowest_frequency) * static_cast<double>(table.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(place), table.size() - 2);
  return std::lerp(table[k], table[k + 1], place - static_cast<double>(k));
}

ErrorMap contrast_error(const Image& full, const Image& test) {
  check_comparable(full, test);
  const std::array<float, 256>& linear = linear_of_srgb();
  const auto luminance = [&](const Image& image, std::size_t pixel) {
    const std::uint8_t* c = &image.rgba[4 * pixel];
    return 0.2126 * linear[c[0]] + 0.7152 * linear[c[1]] + 0.0722 * linear[c[2]];
  };
  const std::size_t pixels = full.rgba.size() / 4;
  double sum = 0;
  for (std::size_t i = 0; i < pixels; ++i) sum += luminance(full, i);
  const double by_mean = 1 / (sum / static_cast<double>(pixels) + light_of_the_room);
  ErrorMap error{full.size, std::vector<float>(pixels)};
  for (std::size_t i = 0; i < pixels; ++i)
    error.value[i] = static_cast<float>((luminance(test, i) - luminance(full, i)) * by_mean);
  return error;
}

std::vector<float> step_visibility(std::span<const float> change, ImageSize size, Scheduler& scheduler,
                                   double pixels_per_degree) {
  if (change.size() != static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height))
    throw InputError("the visibility of a change needs a value for each pixel");
  if (!(pixels_per_degree > 0 && pixels_per_degree <= 1000))
    throw InputError("pixels per degree are more than 0 and at most 1000");
  if (std::ranges::all_of(change, [](float c) { return c == 0; })) return std::vector<float>(change.size(), 0);
  return Spectrum(change, size, pixels_per_degree, scheduler).filtered();
}

}  // namespace lodestone
