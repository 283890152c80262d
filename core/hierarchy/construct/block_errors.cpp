#include "core/hierarchy/construct/block_errors.h"

#include <algorithm>
#include <cmath>

#include "core/math/round_up.h"

namespace lodestone {
namespace {

// A simplifier that measures distances searches around the parents and misses stars that are not fans: around
// non-manifold edges its distances may be many times too large. A block whose largest distance is more than this many
// times the mean is measured again. Smooth scans remain below.
constexpr float doubtful_ratio = 16;

// Distances below this share of the block's largest so far are not distinguished where they are searched for: most
// vertices are done quickly. A cluster build of a sphere of a million triangles takes 8.5 s of CPU for an eighth, 4.0
// for a quarter, 1.5 for a half and 1.0 for three quarters, whose errors at the root are a tenth too large.
constexpr double distinguished = 0.5;

bool is_doubtful(std::span<const float> distance) {
  float largest = 0, sum = 0;
  for (const float d : distance) largest = std::max(largest, d), sum += d;
  return largest * static_cast<float>(distance.size()) > doubtful_ratio * sum;
}

double square(double v) { return v * v; }

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
  for (std::size_t i = 0; i < child.vertex_count(); ++i) {
    const std::uint32_t v = block_id[i];
    const float below = child.vertex_errors.empty() ? child.error : child.vertex_errors[i];
    const float own = searches_ ? search(child.slab.positions[i], VertexId(v)) : result_->distance[v];
    float& error = parent.vertex_errors[child.slab.parents[i]];
    error = std::max(error, float_up(double{below} + std::min(own, child.max_displacement)));
    parent.error = std::max(parent.error, error);
  }
}

float BlockErrors::search(Vec3f from, VertexId vertex) {
  const std::uint32_t parent = result_->parent[vertex];
  const Vec3d moved = to_double(result_->positions[parent]) - to_double(from);
  double squared = dot(moved, moved);
  if (!result_->distance.empty()) squared = std::min(squared, square(result_->distance[vertex]));
  const double small = distinguished * distinguished * largest2_;
  if (squared > small) squared = std::min(squared, surface_.farther(small, from, VertexId(parent)));
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
