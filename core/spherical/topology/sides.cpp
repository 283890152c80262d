#include "core/spherical/topology/sides.h"

#include <algorithm>

#include "core/base/error.h"

namespace lodestone::spherical {

EdgeSides::EdgeSides(std::span<const Triangle> triangles, std::size_t vertex_count)
    : first_(vertex_count + 2), entries_(3 * triangles.size()) {
  if (3 * triangles.size() >= no_id)
    throw ResourceError(describe({}, {}, "more than 1.4 billion triangles", "simplify the mesh first"));
  for (const auto& [v] : triangles)
    for (int k = 0; k < 3; ++k) ++first_[std::min(v[k], v[(k + 1) % 3]) + 2];
  for (std::size_t v = 2; v < first_.size(); ++v) first_[v] += first_[v - 1];
  Id side = 0;
  for (const auto& [v] : triangles)
    for (int k = 0; k < 3; ++k, ++side) {
      const auto [low, high] = std::minmax(v[k], v[(k + 1) % 3]);
      entries_[first_[low + 1]++] = {high, side};
    }
  first_.pop_back();
  for (std::size_t v = 0; v < vertex_count; ++v)
    std::sort(entries_.begin() + first_[v], entries_.begin() + first_[v + 1]);
}

std::vector<Id> opposite_sides(std::span<const Triangle> triangles, std::size_t vertex_count) {
  std::vector<Id> opposite(3 * triangles.size(), no_id);
  EdgeSides(triangles, vertex_count).for_each_edge([&](Id, Id, std::span<const EdgeSides::Entry> entries) {
    if (entries.size() != 2) return;
    opposite[entries[0].side] = entries[1].side;
    opposite[entries[1].side] = entries[0].side;
  });
  return opposite;
}

}  // namespace lodestone::spherical
