// Pictures for the tests of the image metrics, and the slow, obvious twins: direct two-dimensional convolution in
// double precision, straight from the published formulas.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "render/frame/image.h"

namespace lodestone::testing {

using Rgb = std::array<std::uint8_t, 3>;

inline Image make_image(ImageSize size, const std::function<Rgb(int, int)>& colour) {
  Image image{size, {}, {}};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Rgb c = colour(x, y);
      image.rgba.insert(image.rgba.end(), {c[0], c[1], c[2], 255});
    }
  return image;
}

inline Image uniform(ImageSize size, Rgb colour) {
  return make_image(size, [&](int, int) { return colour; });
}

// Smooth colours, hard edges and single points.
inline Image pattern(ImageSize size, unsigned seed) {
  std::mt19937 random(seed);
  const double phase = static_cast<double>(random() % 100) / 10;
  return make_image(size, [&](int x, int y) {
    if (random() % 53 == 0) return Rgb{255, 255, static_cast<std::uint8_t>(random() % 256)};
    const bool dark = (x / 9 + y / 7 + static_cast<int>(seed)) % 3 == 0;
    const auto wave = [&](double f) {
      return static_cast<std::uint8_t>((dark ? 40 : 120) + 40 * std::sin(phase + f * x + 0.13 * y));
    };
    return Rgb{wave(0.11), wave(0.23), wave(0.05)};
  });
}

// ---- FLIP (andersson2020), LDR ----

class NaiveFlip {
 public:
  explicit NaiveFlip(double pixels_per_degree) : ppd_(pixels_per_degree) {}

  std::vector<double> operator()(const Image& reference, const Image& test) const {
    const Seen a = see(reference), b = see(test);
    std::vector<double> map;
    for (std::size_t i = 0; i < a.lab.size(); ++i) {
      const double colour = redistributed(hyab(a.lab[i], b.lab[i]));
      const double edge = std::abs(a.edge[i] - b.edge[i]), point = std::abs(a.point[i] - b.point[i]);
      const double feature = std::pow(std::max(edge, point) / std::sqrt(2.0), 0.5);
      map.push_back(std::pow(colour, 1 - feature));
    }
    return map;
  }

  using Triple = std::array<double, 3>;
  static double srgb_to_linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
  static Triple to_xyz(Triple c) {
    return {(10135552 * c[0] + 8788810 * c[1] + 4435075 * c[2]) / 24577794,
            (2613072 * c[0] + 8788810 * c[1] + 887015 * c[2]) / 12288897,
            (1425312 * c[0] + 8788810 * c[1] + 70074185 * c[2]) / 73733382};
  }
  // Cramer's rule.
  static Triple to_rgb(Triple xyz) {
    const Triple r = to_xyz({1, 0, 0}), g = to_xyz({0, 1, 0}), b = to_xyz({0, 0, 1});
    const auto det = [](Triple u, Triple v, Triple w) {
      return u[0] * (v[1] * w[2] - v[2] * w[1]) - v[0] * (u[1] * w[2] - u[2] * w[1]) +
             w[0] * (u[1] * v[2] - u[2] * v[1]);
    };
    const double d = det(r, g, b);
    return {det(xyz, g, b) / d, det(r, xyz, b) / d, det(r, g, xyz) / d};
  }
  static Triple white() { return to_xyz({1, 1, 1}); }
  static Triple hunt_lab(Triple rgb) {
    const Triple xyz = to_xyz(rgb), w = white();
    const auto f = [](double t) {
      const double d = 6.0 / 29;
      return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
    };
    const double x = f(xyz[0] / w[0]), y = f(xyz[1] / w[1]), z = f(xyz[2] / w[2]), l = 116 * y - 16;
    return {l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)};
  }
  static double hyab(Triple a, Triple b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }
  static double redistributed(double distance) {
    const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7), p = std::pow(distance, 0.7);
    return p < 0.4 * largest ? 0.95 * p / (0.4 * largest) : 0.95 + 0.05 * (p - 0.4 * largest) / (0.6 * largest);
  }

 private:
  struct Seen {
    std::vector<Triple> lab;
    std::vector<double> edge, point;
  };
  struct Kernel2d {
    int radius = 0;
    std::vector<double> weights;
    double& at(int x, int y) { return weights[static_cast<std::size_t>((y + radius) * (2 * radius + 1) + x + radius)]; }
  };

  static Kernel2d sampled(int radius, const std::function<double(int, int)>& weight) {
    Kernel2d kernel{radius, {}};
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) kernel.weights.push_back(weight(x, y));
    return kernel;
  }
  // Positive weights to sum 1, negative ones to -1.
  static Kernel2d balanced(Kernel2d kernel) {
    double positive = 0, negative = 0;
    for (const double w : kernel.weights) (w > 0 ? positive : negative) += std::abs(w);
    for (double& w : kernel.weights) w /= w > 0 ? positive : negative > 0 ? negative : 1;
    return kernel;
  }

  [[nodiscard]] Kernel2d sensitivity(std::size_t channel) const {
    using std::numbers::pi;
    static constexpr double a1[] = {1, 1, 34.1}, b1[] = {0.0047, 0.0053, 0.04}, a2[] = {0, 0, 13.5},
                            b2[] = {1e-5, 1e-5, 0.025};
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd_));
    return balanced(sampled(radius, [&](int x, int y) {
      const double d2 = (x * x + y * y) / (ppd_ * ppd_);
      return a1[channel] * std::sqrt(pi / b1[channel]) * std::exp(-pi * pi * d2 / b1[channel]) +
             a2[channel] * std::sqrt(pi / b2[channel]) * std::exp(-pi * pi * d2 / b2[channel]);
    }));
  }
  enum class Axis : std::uint8_t { across, down };
  [[nodiscard]] Kernel2d feature(bool point, Axis along) const {
    const double sigma = 0.5 * 0.082 * ppd_;
    return balanced(sampled(static_cast<int>(std::ceil(3 * sigma)), [&](int x, int y) {
      const double g = std::exp(-(x * x + y * y) / (2 * sigma * sigma)), t = along == Axis::down ? y : x;
      return point ? (t * t / (sigma * sigma) - 1) * g : -t * g;
    }));
  }

  static std::vector<double> convolved(const std::vector<double>& plane, ImageSize size, Kernel2d kernel) {
    std::vector<double> out;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        double sum = 0;
        for (int j = -kernel.radius; j <= kernel.radius; ++j)
          for (int i = -kernel.radius; i <= kernel.radius; ++i) {
            const int px = std::clamp(x + i, 0, size.width - 1), py = std::clamp(y + j, 0, size.height - 1);
            sum += kernel.at(i, j) * plane[static_cast<std::size_t>(py * size.width + px)];
          }
        out.push_back(sum);
      }
    return out;
  }

  [[nodiscard]] Seen see(const Image& image) const {
    std::array<std::vector<double>, 3> ycc;
    const Triple w = white();
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      Triple rgb{};
      for (std::size_t c = 0; c < 3; ++c) rgb[c] = srgb_to_linear(image.rgba[i + c] / 255.0);
      const Triple xyz = to_xyz(rgb);
      ycc[0].push_back(116 * xyz[1] / w[1] - 16);
      ycc[1].push_back(500 * (xyz[0] / w[0] - xyz[1] / w[1]));
      ycc[2].push_back(200 * (xyz[1] / w[1] - xyz[2] / w[2]));
    }
    std::vector<double> luminance;
    for (const double y : ycc[0]) luminance.push_back((y + 16) / 116);
    for (std::size_t c = 0; c < 3; ++c) ycc[c] = convolved(ycc[c], image.size, sensitivity(c));
    Seen seen;
    for (std::size_t i = 0; i < luminance.size(); ++i) {
      const double y = (ycc[0][i] + 16) / 116, x = y + ycc[1][i] / 500, z = y - ycc[2][i] / 200;
      Triple rgb = to_rgb({x * w[0], y * w[1], z * w[2]});
      for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
      seen.lab.push_back(hunt_lab(rgb));
    }
    seen.edge = lengths(luminance, image.size, false);
    seen.point = lengths(luminance, image.size, true);
    return seen;
  }
  [[nodiscard]] std::vector<double> lengths(const std::vector<double>& luminance, ImageSize size, bool point) const {
    const std::vector<double> across = convolved(luminance, size, feature(point, Axis::across)),
                              down = convolved(luminance, size, feature(point, Axis::down));
    std::vector<double> out;
    for (std::size_t i = 0; i < across.size(); ++i) out.push_back(std::hypot(across[i], down[i]));
    return out;
  }

  double ppd_;
};

// ---- SSIM (wang2004) ----

inline double naive_ssim(const Image& a, const Image& b) {
  const auto luma = [](const Image& image, int x, int y) {
    const std::uint8_t* c = &image.rgba[4 * static_cast<std::size_t>(y * image.size.width + x)];
    return 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
  };
  double weights[11][11], weight_sum = 0;
  for (int j = 0; j < 11; ++j)
    for (int i = 0; i < 11; ++i)
      weight_sum += weights[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / (2 * 1.5 * 1.5));
  double sum = 0;
  int places = 0;
  for (int y = 0; y + 11 <= a.size.height; ++y)
    for (int x = 0; x + 11 <= a.size.width; ++x, ++places) {
      double ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      const auto for_window = [&](const auto& body) {
        for (int j = 0; j < 11; ++j)
          for (int i = 0; i < 11; ++i) body(weights[j][i] / weight_sum, luma(a, x + i, y + j), luma(b, x + i, y + j));
      };
      for_window([&](double w, double u, double v) { ma += w * u, mb += w * v; });
      for_window([&](double w, double u, double v) {
        va += w * (u - ma) * (u - ma), vb += w * (v - mb) * (v - mb), cov += w * (u - ma) * (v - mb);
      });
      const double c1 = 6.5025, c2 = 58.5225;
      sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    }
  return sum / places;
}

}  // namespace lodestone::testing
