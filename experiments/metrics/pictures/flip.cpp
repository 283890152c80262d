#include "experiments/metrics/pictures/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/metrics/pictures/differing_columns.h"
#include "experiments/metrics/pictures/flip_colour.h"
#include "experiments/metrics/pictures/flip_kernels.h"

namespace lodestone {
namespace {

constexpr std::size_t flip_rows_per_chunk = 8;

// Planes of a picture in the opponent space, filled where filters read them.
struct Opponent {
  ImageSize size;
  std::array<std::vector<float>, 3> plane;  // luminance, red-green, blue-yellow

  Opponent(const Image& image, const DifferingColumns& differing, std::size_t reach, Scheduler& scheduler)
      : size(image.size) {
    for (auto& p : plane) p.resize(image.rgba.size() / 4);
    const std::array<float, 256> linear = flip::linear_of_srgb();
    const auto width = static_cast<std::size_t>(size.width);
    scheduler.for_chunks(static_cast<std::size_t>(size.height), flip_rows_per_chunk, [&](ChunkRange rows) {
      for (std::size_t y = rows.begin; y < rows.end; ++y) {
        const Columns columns = differing.near(y, 2 * reach, 2 * reach);
        for (std::size_t i = y * width + columns.begin; i < y * width + columns.end; ++i) convert(image, linear, i);
      }
    });
  }

 private:
  void convert(const Image& image, const std::array<float, 256>& linear, std::size_t pixel) {
    const std::uint8_t* c = &image.rgba[4 * pixel];
    const flip::Colour ycc = flip::opponent_of_linear({linear[c[0]], linear[c[1]], linear[c[2]]});
    for (std::size_t k = 0; k < 3; ++k) plane[k][pixel] = ycc[k];
  }
};

using Row = std::vector<float>;

// sum[x] += weight * from[x]: the whole work of the filters, in a form that compilers turn into vectors.
void add_scaled(const float* __restrict from, float weight, float* __restrict sum, std::size_t count) {
  for (std::size_t x = 0; x < count; ++x) sum[x] += weight * from[x];
}

// `columns` of row y of a plane, and `radius` more on either side, filtered down the columns; the border is repeated
// outside of the picture.
void filter_columns(const std::vector<float>& plane, ImageSize size, int y, Columns columns, const flip::Kernel& kernel,
                    Row& out) {
  const auto width = static_cast<std::size_t>(size.width), radius = static_cast<std::size_t>(kernel.radius());
  out.assign(columns.size() + 2 * radius, 0);
  const std::size_t begin = columns.begin > radius ? columns.begin - radius : 0,
                    end = std::min(width, columns.end + radius), before = begin + radius - columns.begin;
  float* inside = out.data() + before;
  for (int k = -kernel.radius(); k <= kernel.radius(); ++k) {
    const auto row = static_cast<std::size_t>(std::clamp(y + k, 0, size.height - 1));
    add_scaled(plane.data() + row * width + begin, kernel.at(k), inside, end - begin);
  }
  std::fill_n(out.begin(), before, inside[0]);
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(before + end - begin), out.end(), inside[end - begin - 1]);
}

void add_filtered_row(const Row& padded, const flip::Kernel& kernel, float scale, Row& out) {
  const int radius = kernel.radius();
  for (int k = -radius; k <= radius; ++k)
    add_scaled(padded.data() + radius + k, scale * kernel.at(k), out.data(), out.size());
}

// From the opponent space, in place.
void to_hunt_lab(float* __restrict u, float* __restrict v, float* __restrict w, std::size_t count) {
  for (std::size_t x = 0; x < count; ++x) {
    const flip::Colour lab = flip::hunt_lab_of_opponent({u[x], v[x], w[x]});
    u[x] = lab[0], v[x] = lab[1], w[x] = lab[2];
  }
}

// Values that FLIP compares in some columns of a row of a picture.
struct SeenRow {
  std::array<Row, 3> colour;                             // filtered by the contrast sensitivity, L*a*b* after Hunt
  Row edge_across, edge_down, point_across, point_down;  // derivatives of the luminance

  void compute(const Opponent& picture, int y, Columns columns, const flip::Kernels& kernels, Row& padded) {
    const auto down = [&](std::size_t plane, const flip::Kernel& kernel) {
      filter_columns(picture.plane[plane], picture.size, y, columns, kernel, padded);
    };
    for (std::size_t c = 0; c < 3; ++c) {
      colour[c].assign(columns.size(), 0);
      for (const flip::WeightedKernel& part : kernels.sensitivity[c]) {
        down(c, part.kernel);
        add_filtered_row(padded, part.kernel, part.weight, colour[c]);
      }
    }
    for (Row* row : {&edge_across, &edge_down, &point_across, &point_down}) row->assign(columns.size(), 0);
    down(0, kernels.smooth);
    add_filtered_row(padded, kernels.edge, 1, edge_across);
    add_filtered_row(padded, kernels.point, 1, point_across);
    down(0, kernels.edge);
    add_filtered_row(padded, kernels.smooth, 1, edge_down);
    down(0, kernels.point);
    add_filtered_row(padded, kernels.smooth, 1, point_down);
    to_hunt_lab(colour[0].data(), colour[1].data(), colour[2].data(), columns.size());
  }
};

float colour_difference(const SeenRow& a, const SeenRow& b, std::size_t x) {
  const auto at = [x](const SeenRow& row) {
    return flip::Colour{row.colour[0][x], row.colour[1][x], row.colour[2][x]};
  };
  return flip::colour_error(flip::hyab(at(a), at(b)));
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
  const std::size_t reach = kernels.radius();
  const DifferingColumns differing(reference, test);
  const Opponent a(reference, differing, reach, scheduler), b(test, differing, reach, scheduler);
  ErrorMap map{reference.size, std::vector<float>(a.plane[0].size())};
  const auto width = static_cast<std::size_t>(map.size.width);
  scheduler.for_chunks(static_cast<std::size_t>(map.size.height), flip_rows_per_chunk, [&](ChunkRange rows) {
    SeenRow seen_a, seen_b;
    Row padded;
    for (std::size_t y = rows.begin; y < rows.end; ++y) {
      const Columns columns = differing.near(y, reach, reach);  // the error is 0 outside
      if (columns.size() == 0) continue;
      seen_a.compute(a, static_cast<int>(y), columns, kernels, padded);
      seen_b.compute(b, static_cast<int>(y), columns, kernels, padded);
      for (std::size_t x = 0; x < columns.size(); ++x)
        map.value[y * width + columns.begin + x] =
            std::pow(colour_difference(seen_a, seen_b, x), 1 - feature_difference(seen_a, seen_b, x));
    }
  });
  return map;
}

}  // namespace lodestone
