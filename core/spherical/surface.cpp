#include "core/spherical/surface.h"

#include <algorithm>
#include <cstddef>

#include "core/base/disjoint_sets.h"

namespace lodestone::spherical {
namespace {

// A side of a triangle between its ends in ascending order.
struct Side {
  std::uint32_t low = 0, high = 0;
  std::uint32_t corner = 0;  // 3 * triangle + the place that the side starts at
  bool forward = false;      // the triangle runs from low to high

  [[nodiscard]] bool is_same_edge(const Side& other) const { return low == other.low && high == other.high; }
};

std::vector<Side> sorted_sides(std::span<const Triangle> triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (is_degenerate(triangles[t])) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t].v[k], b = triangles[t].v[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), 3 * t + k, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.corner < b.corner;
  });
  return sides;
}

// Corners of a vertex that follow each other across properly shared edges are one fan.
std::uint64_t count_fans(std::span<const Triangle> triangles, DisjointSets& fans) {
  std::uint64_t count = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (!is_degenerate(triangles[t]))
      for (std::uint32_t k = 0; k < 3; ++k) count += fans.find(3 * t + k) == 3 * t + k;
  return count;
}

}  // namespace

SurfaceKind kind_of(std::span<const Triangle> triangles, std::size_t vertex_count) {
  SurfaceKind kind;
  const std::vector<Side> sides = sorted_sides(triangles);
  DisjointSets fans(3 * triangles.size()), parts(vertex_count);
  std::uint64_t edges = 0;
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].is_same_edge(sides[begin])) ++end;
    ++edges;
    parts.unite(sides[begin].low, sides[begin].high);
    const Side &first = sides[begin], &last = sides[end - 1];
    if (end - begin != 2 || first.forward == last.forward) {
      ++kind.open_edges;
      continue;
    }
    const auto after = [](std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; };
    fans.unite(first.corner, after(last.corner));
    fans.unite(last.corner, after(first.corner));
  }
  std::vector<bool> used(vertex_count);
  for (const Triangle& t : triangles) {
    if (is_degenerate(t)) ++kind.degenerate;
    for (const std::uint32_t v : t.v) used[v] = true;
  }
  std::uint64_t vertices = 0;
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (!used[v]) continue;
    ++vertices;
    kind.components += parts.find(v) == v;
  }
  kind.unused = vertex_count - vertices;
  const std::uint64_t faces = triangles.size() - kind.degenerate;
  kind.split_fans = kind.degenerate > 0 ? 0 : count_fans(triangles, fans) - vertices;
  kind.euler = static_cast<std::int64_t>(vertices + faces) - static_cast<std::int64_t>(edges);
  return kind;
}

bool is_sphere(const Surface& surface) {
  return kind_of(surface.triangles, surface.positions.size()) == SurfaceKind{.components = 1, .euler = 2};
}

}  // namespace lodestone::spherical
