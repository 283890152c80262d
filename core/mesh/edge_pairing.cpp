#include "core/mesh/edge_pairing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace lodestone {
namespace {

struct Placed {
  EdgeTriangle triangle;
  double angle = 0;  // around the edge, from the lower end to the higher one
};

// Any two vectors that make a right-handed frame with the axis; the same for the same axis.
std::pair<Vec3d, Vec3d> frame_around(Vec3d axis) {
  const Vec3d other = std::abs(axis.x) <= std::abs(axis.y) && std::abs(axis.x) <= std::abs(axis.z) ? Vec3d{1, 0, 0}
                      : std::abs(axis.y) <= std::abs(axis.z)                                       ? Vec3d{0, 1, 0}
                                                                                                   : Vec3d{0, 0, 1};
  const Vec3d first = cross(axis, other);
  return {first, cross(axis, first)};
}

bool comes_before(const Placed& a, const Placed& b) {
  if (a.angle != b.angle) return a.angle < b.angle;
  if (!(a.triangle.third == b.triangle.third)) return is_lower(a.triangle.third, b.triangle.third);
  return a.triangle.forward < b.triangle.forward;
}

// A solid begins after a backward triangle and ends at a forward one. Two turns around the edge, as brackets may begin
// anywhere.
std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_brackets(std::span<const Placed> sorted) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<std::size_t> pending;
  std::vector<bool> done(sorted.size());
  for (std::size_t step = 0; step < 2 * sorted.size(); ++step) {
    const std::size_t k = step % sorted.size();
    if (done[k]) continue;
    if (!sorted[k].triangle.forward) {
      if (step < sorted.size()) pending.push_back(k);
    } else if (!pending.empty()) {
      pairs.emplace_back(sorted[pending.back()].triangle.name, sorted[k].triangle.name);
      done[pending.back()] = done[k] = true;
      pending.pop_back();
    }
  }
  return pairs;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_around_edge(Vec3f low, Vec3f high,
                                                                      const std::vector<EdgeTriangle>& triangles) {
  const Vec3d origin = to_double(low);
  const Vec3d axis = to_double(high) - origin;
  const auto [x, y] = frame_around(axis);
  std::vector<Placed> around;
  for (const EdgeTriangle& triangle : triangles) {
    const Vec3d out = to_double(triangle.third) - origin;
    around.push_back({triangle, std::atan2(dot(out, y) / std::max(length(axis), 1e-30), dot(out, x))});
  }
  std::sort(around.begin(), around.end(), comes_before);
  return pair_brackets(around);
}

}  // namespace lodestone
