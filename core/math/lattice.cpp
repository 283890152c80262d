#include "core/math/lattice.h"

#include <algorithm>
#include <utility>

namespace lodestone {
namespace {

constexpr std::size_t sample_size = 1 << 16;
constexpr int least_bits = 16;
constexpr double steps_per_median = 256, steps_per_short = 16;
constexpr std::size_t short_share = 20;  // one edge of this many is shorter than a "short" one

double smallest_but(std::vector<double>& values, std::size_t smaller) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(smaller);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

Lattice choose_lattice(std::span<const Vec3d> positions, std::span<const Triangle> triangles, double scale) {
  std::vector<double> edges;
  for (std::size_t i = 0; i < triangles.size(); i += lattice_sample_stride(triangles.size())) {
    const auto& v = triangles[i].v;
    if (!is_degenerate(triangles[i])) append_edges(positions[v[0]], positions[v[1]], positions[v[2]], scale, edges);
  }
  return lattice_for(std::move(edges));
}

std::size_t lattice_sample_stride(std::size_t triangles) { return 1 + triangles / sample_size; }

void append_edges(const Vec3d& a, const Vec3d& b, const Vec3d& c, double scale, std::vector<double>& edges) {
  for (const Vec3d& side : {a - b, b - c, c - a}) {
    const double edge = length((1 / scale) * side);
    if (edge > 0 && std::isfinite(edge)) edges.push_back(edge);
  }
}

Lattice lattice_for(std::vector<double> edges) {
  if (edges.empty()) return {Lattice::most_bits};
  const double step = std::min(smallest_but(edges, edges.size() / 2) / steps_per_median,
                               smallest_but(edges, edges.size() / short_share) / steps_per_short);
  Lattice lattice{least_bits};
  while (lattice.bits < Lattice::most_bits && lattice.step() > step) ++lattice.bits;
  return lattice;
}

}  // namespace lodestone
