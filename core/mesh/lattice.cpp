#include "core/mesh/lattice.h"

#include <algorithm>
#include <vector>

namespace lodestone {
namespace {

constexpr std::size_t sample_size = 1 << 16;
constexpr int least_bits = 16;
constexpr double steps_per_median = 256, steps_per_short = 16;
constexpr std::size_t short_share = 20;  // one edge of this many is shorter than a "short" one

std::vector<double> edge_lengths(std::span<const Vec3d> positions, std::span<const Triangle> triangles, double scale) {
  std::vector<double> lengths;
  const std::size_t stride = 1 + triangles.size() / sample_size;
  for (std::size_t i = 0; i < triangles.size(); i += stride) {
    const auto& v = triangles[i].v;
    if (is_degenerate(triangles[i])) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double edge = length((1 / scale) * (positions[v[k]] - positions[v[(k + 1) % 3]]));
      if (edge > 0 && std::isfinite(edge)) lengths.push_back(edge);
    }
  }
  return lengths;
}

double smallest_but(std::vector<double>& values, std::size_t smaller) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(smaller);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

Lattice choose_lattice(std::span<const Vec3d> positions, std::span<const Triangle> triangles, double scale) {
  std::vector<double> edges = edge_lengths(positions, triangles, scale);
  if (edges.empty()) return {Lattice::most_bits};
  const double step = std::min(smallest_but(edges, edges.size() / 2) / steps_per_median,
                               smallest_but(edges, edges.size() / short_share) / steps_per_short);
  Lattice lattice{least_bits};
  while (lattice.bits < Lattice::most_bits && lattice.step() > step) ++lattice.bits;
  return lattice;
}

}  // namespace lodestone
