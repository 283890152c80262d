#include "experiments/metrics/pictures/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/metrics/pictures/differing_columns.h"
#include "experiments/metrics/pictures/error_map.h"

namespace lodestone {
namespace {

constexpr int window = 11;
constexpr std::size_t rows_per_chunk = 64;  // each averages ten rows more, over columns

std::array<double, window> gaussian() {
  constexpr double sigma = 1.5;
  std::array<double, window> weights{};
  double sum = 0;
  for (int i = 0; i < window; ++i) {
    const double x = i - window / 2;
    sum += weights[static_cast<std::size_t>(i)] = std::exp(-x * x / (2 * sigma * sigma));
  }
  for (double& w : weights) w /= sum;
  return weights;
}

// Values averaged over the window: both lumas, their squares and their product.
enum Moment : std::size_t { of_a, of_b, of_aa, of_bb, of_ab, moments };
using MomentRow = std::array<std::vector<double>, moments>;

double luma(const Image& image, std::size_t pixel) {
  const std::uint8_t* c = &image.rgba[4 * pixel];
  return 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
}

// Moments of row y at each of its pixels, from the place of one window to the end of another.
void fill_moments(const Image& a, const Image& b, std::size_t y, Columns places, MomentRow& row) {
  const auto width = static_cast<std::size_t>(a.size.width);
  for (std::vector<double>& moment : row) moment.resize(width);
  for (std::size_t x = places.begin; x < places.end + window - 1; ++x) {
    const std::size_t pixel = y * width + x;
    const double u = luma(a, pixel), v = luma(b, pixel);
    row[of_a][x] = u, row[of_b][x] = v;
    row[of_aa][x] = u * u, row[of_bb][x] = v * v, row[of_ab][x] = u * v;
  }
}

// Weighted over columns, for some places of the window: entry x is that of columns x .. x + window - 1.
void average_row(const MomentRow& from, Columns places, const std::array<double, window>& weights, MomentRow& out) {
  for (std::size_t m = 0; m < moments; ++m) {
    out[m].assign(from[m].size(), 0);
    for (std::size_t k = 0; k < window; ++k)
      for (std::size_t x = places.begin; x < places.end; ++x) out[m][x] += weights[k] * from[m][x + k];
  }
}

// Places of the window that see a difference of the columns. `count`: of a row.
Columns places_over(Columns columns, std::size_t count) {
  if (columns.size() == 0) return {};
  return {columns.begin >= window ? columns.begin - window + 1 : 0, std::min(columns.end, count)};
}

double index_of(double mean_a, double mean_b, double aa, double bb, double ab) {
  constexpr double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
  const double variance_a = aa - mean_a * mean_a, variance_b = bb - mean_b * mean_b, covariance = ab - mean_a * mean_b;
  return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
         ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
}

}  // namespace

double ssim(const Image& a, const Image& b, Scheduler& scheduler) {
  check_comparable(a, b);
  if (a.size.width < window || a.size.height < window) throw InputError("SSIM needs pictures of at least 11x11 pixels");
  const std::array<double, window> weights = gaussian();
  const auto height = static_cast<std::size_t>(a.size.height);
  const std::size_t places = static_cast<std::size_t>(a.size.width) - window + 1, rows = height - window + 1;

  const DifferingColumns differing(a, b);

  std::vector<double> sums(chunk_count(rows, rows_per_chunk), 0);
  scheduler.for_chunks(rows, rows_per_chunk, [&](ChunkRange chunk) {
    // The last `window` rows, averaged over columns, row y at y mod window.
    std::array<MomentRow, window> averaged;
    MomentRow scratch;
    std::array<std::vector<double>, moments> total;
    for (std::size_t y = chunk.begin; y < chunk.end + window - 1; ++y) {
      const Columns seen = places_over(differing.near(y, window - 1, 0), places);
      fill_moments(a, b, y, seen, scratch);
      average_row(scratch, seen, weights, averaged[y % window]);
      if (y + 1 < chunk.begin + window) continue;
      const std::size_t top = y + 1 - window;
      const Columns over = places_over(differing.near(top + window / 2, window / 2, 0), places);
      for (std::size_t m = 0; m < moments; ++m) {
        total[m].assign(places, 0);
        for (std::size_t k = 0; k < window; ++k) {
          const std::vector<double>& row = averaged[(top + k) % window][m];
          for (std::size_t x = over.begin; x < over.end; ++x) total[m][x] += weights[k] * row[x];
        }
      }
      sums[chunk.index] += static_cast<double>(places - over.size());  // the index of equal windows is 1
      for (std::size_t x = over.begin; x < over.end; ++x)
        sums[chunk.index] +=
            index_of(total[of_a][x], total[of_b][x], total[of_aa][x], total[of_bb][x], total[of_ab][x]);
    }
  });
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum / static_cast<double>(rows * places);
}

}  // namespace lodestone
