#include "core/hierarchy/construct/block_errors.h"

#include <algorithm>
#include <cmath>

#include "core/math/round_up.h"

namespace lodestone {
namespace {

// A simplifier that measures distances searches around the parents and misses stars that are not fans: around
// non-manifold edges its distances may be many times too large. A block whose largest distance is more than this many
// times the mean is measured again where it matters. Smooth scans remain below.
constexpr float doubtful_ratio = 16;

bool is_doubtful(std::span<const float> distance) {
  float largest = 0, sum = 0;
  for (const float d : distance) largest = std::max(largest, d), sum += d;
  return largest * static_cast<float>(distance.size()) > doubtful_ratio * sum;
}

// A bound of the squared distance of a vertex of the block from the coarser surface.
double bound2(const SimplifyResult& result, Vec3f from, std::uint32_t vertex) {
  const Vec3d moved = to_double(result.positions[result.parent[vertex]]) - to_double(from);
  if (result.distance.empty()) return dot(moved, moved);
  const double measured = result.distance[vertex];
  return std::min(dot(moved, moved), measured * measured);
}

}  // namespace

void BlockErrors::begin(const SimplifyResult& result, std::span<const Triangle> triangles) {
  result_ = &result, largest2_ = 0;
  searches_ = result.distance.empty() || is_doubtful(result.distance);
  if (!searches_) return;
  images_.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& v = triangles[t].v;
    images_[t] = {{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}};
  }
  surface_.reset(images_, result.positions);
}

// The error of the parent is the largest of its vertices: where a child is worst, and where its vertices go farthest,
// are seldom the same place.
void BlockErrors::add(const CellBuild& child, std::span<const std::uint32_t> block_id, CellBuild& parent) {
  const bool measured = !result_->distance.empty();
  float most = child.max_displacement;
  if (searches_) most = std::min(most, search_largest(child, block_id));
  for (std::size_t i = 0; i < child.vertex_count(); ++i) {
    const std::uint32_t v = block_id[i];
    const float below = child.vertex_errors.empty() ? child.error : child.vertex_errors[i];
    const float own =
        measured ? result_->distance[v] : float_above(std::sqrt(bound2(*result_, child.slab.positions[i], v)));
    float& error = parent.vertex_errors[child.slab.parents[i]];
    error = std::max(error, float_up(double{below} + std::min(own, most)));
    parent.error = std::max(parent.error, error);
  }
}

// Distances below three quarters of the block's largest so far are not distinguished: most vertices are done quickly,
// and the largest distance, the figure that matters, remains exact.
float BlockErrors::search_largest(const CellBuild& child, std::span<const std::uint32_t> block_id) {
  double squared = 0.5625 * largest2_;
  for (std::size_t i = 0; i < child.vertex_count(); ++i) {
    const Vec3f from = child.slab.positions[i];
    if (bound2(*result_, from, block_id[i]) > squared)
      squared = surface_.farther(squared, from, VertexId(result_->parent[block_id[i]]));
  }
  largest2_ = std::max(largest2_, squared);
  return float_above(std::sqrt(squared));
}

void fill_border_errors(CellBuild& cell) {
  const std::vector<float>& of = cell.vertex_errors;
  const std::size_t first = cell.first_shared();
  cell.border_errors.assign(of.begin() + static_cast<std::ptrdiff_t>(first), of.end());
  for (const Triangle& t : cell.triangles) {
    if (std::max({t.v[0], t.v[1], t.v[2]}) < first) continue;
    const float largest = std::max({of[t.v[0]], of[t.v[1]], of[t.v[2]]});
    for (const std::uint32_t v : t.v)
      if (v >= first) cell.border_errors[v - first] = std::max(cell.border_errors[v - first], largest);
  }
}

}  // namespace lodestone
