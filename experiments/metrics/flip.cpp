#include "experiments/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/metrics/flip_colour.h"
#include "experiments/metrics/flip_kernels.h"

namespace lodestone {
namespace {

constexpr std::size_t rows_per_chunk = 8;

// Planes of a picture in the opponent space.
struct Opponent {
  ImageSize size;
  std::array<std::vector<float>, 3> plane;  // luminance, red-green, blue-yellow

  explicit Opponent(const Image& image) : size(image.size) {
    const std::size_t pixels = image.rgba.size() / 4;
    for (auto& p : plane) p.resize(pixels);
    const std::array<float, 256> linear = flip::linear_of_srgb();
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::uint8_t* c = &image.rgba[4 * i];
      const flip::Colour ycc = flip::opponent_of_linear({linear[c[0]], linear[c[1]], linear[c[2]]});
      for (std::size_t k = 0; k < 3; ++k) plane[k][i] = ycc[k];
    }
  }
};

using Row = std::vector<float>;

// sum[x] += weight * from[x]: the whole work of the filters, in a form that compilers turn into vectors.
void add_scaled(const float* __restrict from, float weight, float* __restrict sum, std::size_t count) {
  for (std::size_t x = 0; x < count; ++x) sum[x] += weight * from[x];
}

// Row y of a plane filtered down the columns, the border repeated outside. Room for `radius` values on either side.
void filter_columns(const std::vector<float>& plane, ImageSize size, int y, const flip::Kernel& kernel, Row& out) {
  const auto width = static_cast<std::size_t>(size.width);
  const int radius = kernel.radius();
  out.assign(width + 2 * static_cast<std::size_t>(radius), 0);
  float* middle = out.data() + radius;
  for (int k = -radius; k <= radius; ++k) {
    const auto row = static_cast<std::size_t>(std::clamp(y + k, 0, size.height - 1));
    add_scaled(plane.data() + row * width, kernel.at(k), middle, width);
  }
  std::fill_n(out.data(), radius, middle[0]);
  std::fill_n(middle + width, radius, middle[width - 1]);
}

void add_filtered_row(const Row& padded, const flip::Kernel& kernel, float scale, Row& out) {
  const int radius = kernel.radius();
  for (int k = -radius; k <= radius; ++k)
    add_scaled(padded.data() + radius + k, scale * kernel.at(k), out.data(), out.size());
}

// What FLIP compares in one row of a picture.
struct SeenRow {
  std::array<Row, 3> colour;                             // filtered by the contrast sensitivity, opponent space
  Row edge_across, edge_down, point_across, point_down;  // derivatives of the luminance

  void compute(const Opponent& picture, int y, const flip::Kernels& kernels, Row& padded) {
    const auto width = static_cast<std::size_t>(picture.size.width);
    for (std::size_t c = 0; c < 3; ++c) {
      colour[c].assign(width, 0);
      for (const flip::WeightedKernel& part : kernels.sensitivity[c]) {
        filter_columns(picture.plane[c], picture.size, y, part.kernel, padded);
        add_filtered_row(padded, part.kernel, part.weight, colour[c]);
      }
    }
    for (Row* row : {&edge_across, &edge_down, &point_across, &point_down}) row->assign(width, 0);
    const std::vector<float>& luminance = picture.plane[0];
    filter_columns(luminance, picture.size, y, kernels.smooth, padded);
    add_filtered_row(padded, kernels.edge, 1, edge_across);
    add_filtered_row(padded, kernels.point, 1, point_across);
    filter_columns(luminance, picture.size, y, kernels.edge, padded);
    add_filtered_row(padded, kernels.smooth, 1, edge_down);
    filter_columns(luminance, picture.size, y, kernels.point, padded);
    add_filtered_row(padded, kernels.smooth, 1, point_down);
  }
};

float colour_difference(const SeenRow& a, const SeenRow& b, std::size_t x) {
  const auto adjusted = [x](const SeenRow& row) {
    return flip::hunt_lab_of_opponent({row.colour[0][x], row.colour[1][x], row.colour[2][x]});
  };
  return flip::colour_error(flip::hyab(adjusted(a), adjusted(b)));
}

float feature_difference(const SeenRow& a, const SeenRow& b, std::size_t x) {
  // The features are those of luminance over its range, 116.
  constexpr float range = 116;
  const auto length = [x](const Row& u, const Row& v) { return std::sqrt(u[x] * u[x] + v[x] * v[x]); };
  const float edges = std::abs(length(a.edge_across, a.edge_down) - length(b.edge_across, b.edge_down));
  const float points = std::abs(length(a.point_across, a.point_down) - length(b.point_across, b.point_down));
  return flip::feature_error(std::max(edges, points) / range);
}

}  // namespace

ErrorMap flip_error(const Image& reference, const Image& test, Scheduler& scheduler, const FlipConfig& config) {
  check_comparable(reference, test);
  if (!(config.pixels_per_degree > 0 && config.pixels_per_degree <= 1000))
    throw InputError("FLIP: pixels per degree must lie above 0, at most 1000");
  const flip::Kernels kernels = flip::make_kernels(config.pixels_per_degree);
  const Opponent a(reference), b(test);
  ErrorMap map{reference.size, std::vector<float>(a.plane[0].size())};
  const auto width = static_cast<std::size_t>(map.size.width);
  scheduler.for_chunks(static_cast<std::size_t>(map.size.height), rows_per_chunk, [&](ChunkRange rows) {
    SeenRow seen_a, seen_b;
    Row padded;
    for (std::size_t y = rows.begin; y < rows.end; ++y) {
      seen_a.compute(a, static_cast<int>(y), kernels, padded);
      seen_b.compute(b, static_cast<int>(y), kernels, padded);
      for (std::size_t x = 0; x < width; ++x)
        map.value[y * width + x] =
            std::pow(colour_difference(seen_a, seen_b, x), 1 - feature_difference(seen_a, seen_b, x));
    }
  });
  return map;
}

}  // namespace lodestone
