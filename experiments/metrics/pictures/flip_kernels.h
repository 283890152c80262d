// The filters of FLIP (andersson2020) as one-dimensional kernels.
//
// Contrast sensitivity: of luminance and red-green one Gaussian each, of blue-yellow the sum of two. Normalised to sum
// 1 over the square that they are cut to, a product of two one-dimensional Gaussians remains one, and a sum of such
// products needs the shares of the parts. Features: a derivative of a Gaussian along one axis times the Gaussian along
// the other; normalised so that positive weights sum to 1 and negative ones to -1, which is again a property of each
// factor.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace lodestone::flip {

// Weights at -radius .. radius.
struct Kernel {
  std::vector<float> weights;
  [[nodiscard]] int radius() const { return static_cast<int>(weights.size() / 2); }
  [[nodiscard]] float at(int offset) const { return weights[static_cast<std::size_t>(offset + radius())]; }
};

struct WeightedKernel {
  Kernel kernel;  // to be applied along rows and columns
  float weight = 1;
};

struct Kernels {
  std::array<std::vector<WeightedKernel>, 3> sensitivity;  // of luminance, red-green, blue-yellow
  Kernel smooth, edge, point;                              // Gaussian, its first and second derivative

  // Pixels that the widest of them reaches.
  [[nodiscard]] std::size_t radius() const {
    int widest = std::max({smooth.radius(), edge.radius(), point.radius()});
    for (const std::vector<WeightedKernel>& parts : sensitivity)
      for (const WeightedKernel& part : parts) widest = std::max(widest, part.kernel.radius());
    return static_cast<std::size_t>(widest);
  }
};

// a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees: published for the three channels.
struct SensitivityTerm {
  double a = 0, b = 1;
};
inline constexpr SensitivityTerm luminance_term{1, 0.0047}, red_green_term{1, 0.0053},
    blue_yellow_terms[2] = {{34.1, 0.04}, {13.5, 0.025}};
inline constexpr double widest_b = 0.04;        // of all terms: they are all cut to 3 deviations of this one
inline constexpr double feature_width = 0.082;  // degrees, of what counts as an edge or point; 2 deviations

namespace detail {

template <class Weight>
std::vector<double> sampled(int radius, const Weight& weight) {
  std::vector<double> values;
  for (int x = -radius; x <= radius; ++x) values.push_back(weight(static_cast<double>(x)));
  return values;
}

inline double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum;
}

inline Kernel to_kernel(const std::vector<double>& values) {
  Kernel kernel;
  for (const double v : values) kernel.weights.push_back(static_cast<float>(v));
  return kernel;
}

// Positive weights to sum 1, negative ones to sum -1.
inline Kernel balanced(std::vector<double> values) {
  double positive = 0, negative = 0;
  for (const double v : values) (v > 0 ? positive : negative) += std::abs(v);
  for (double& v : values) {
    if (v > 0) v /= positive;
    if (v < 0) v /= negative;
  }
  return to_kernel(values);
}

inline std::vector<WeightedKernel> sensitivity(const std::vector<SensitivityTerm>& terms, int radius, double ppd) {
  using std::numbers::pi;
  std::vector<WeightedKernel> kernels;
  double whole = 0;
  for (const SensitivityTerm& term : terms) {
    std::vector<double> g =
        sampled(radius, [&](double x) { return std::exp(-pi * pi * (x / ppd) * (x / ppd) / term.b); });
    const double sum = sum_of(g), share = term.a * std::sqrt(pi / term.b) * sum * sum;
    for (double& v : g) v /= sum;
    kernels.push_back({to_kernel(g), static_cast<float>(share)});
    whole += share;
  }
  for (WeightedKernel& k : kernels) k.weight = static_cast<float>(k.weight / whole);
  return kernels;
}

}  // namespace detail

// ppd: pixels per degree.
[[nodiscard]] inline Kernels make_kernels(double ppd) {
  using std::numbers::pi;
  Kernels kernels;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest_b / (2 * pi * pi)) * ppd));
  kernels.sensitivity[0] = detail::sensitivity({luminance_term}, radius, ppd);
  kernels.sensitivity[1] = detail::sensitivity({red_green_term}, radius, ppd);
  kernels.sensitivity[2] = detail::sensitivity({blue_yellow_terms[0], blue_yellow_terms[1]}, radius, ppd);

  const double deviation = 0.5 * feature_width * ppd, variance = deviation * deviation;
  const int reach = static_cast<int>(std::ceil(3 * deviation));
  const auto gaussian = [&](double x) { return std::exp(-x * x / (2 * variance)); };
  std::vector<double> smooth = detail::sampled(reach, gaussian);
  const double sum = detail::sum_of(smooth);
  for (double& v : smooth) v /= sum;
  kernels.smooth = detail::to_kernel(smooth);
  kernels.edge = detail::balanced(detail::sampled(reach, [&](double x) { return -x * gaussian(x); }));
  kernels.point =
      detail::balanced(detail::sampled(reach, [&](double x) { return (x * x / variance - 1) * gaussian(x); }));
  return kernels;
}

}  // namespace lodestone::flip
