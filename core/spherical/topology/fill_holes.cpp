#include "core/spherical/topology/fill_holes.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

namespace lodestone::spherical {
namespace {

constexpr std::size_t largest_fan = 12;

Id add_vertex(Surface& surface, Vec3d position) {
  surface.positions.push_back(position);
  surface.source_vertex.push_back(no_source);
  return static_cast<Id>(surface.positions.size() - 1);
}

void add_triangle(Surface& surface, Id a, Id b, Id c) {
  surface.triangles.push_back({{a, b, c}});
  surface.source_triangle.push_back(no_source);
}

Vec3d centre_of(const Surface& surface, std::span<const Id> loop) {
  Vec3d sum;
  for (const Id v : loop) sum = sum + surface.positions[v];
  return (1.0 / static_cast<double>(loop.size())) * sum;
}

// Joins a loop to a smoother one inside with half as many vertices, which is returned.
std::vector<Id> add_ring(Surface& surface, const std::vector<Id>& loop) {
  const std::size_t n = loop.size(), m = (n + 1) / 2;
  const Vec3d centre = centre_of(surface, loop);
  const double kept = 1 - std::min(0.5, 2 * std::numbers::pi / static_cast<double>(n));
  std::vector<Id> inner;
  for (std::size_t k = 0; k < m; ++k) {
    const auto point = [&](std::size_t i) { return surface.positions[loop[i % n]]; };
    const Vec3d mean = 0.25 * (point(2 * k) + 2 * point(2 * k + 1) + point(2 * k + 2));
    inner.push_back(add_vertex(surface, centre + kept * (mean - centre)));
  }
  for (std::size_t k = 0; k < m; ++k) {
    const bool has_two = 2 * k + 1 < n;
    const Id last = loop[has_two ? (2 * k + 2) % n : 0];
    add_triangle(surface, loop[2 * k], has_two ? loop[2 * k + 1] : last, inner[k]);
    if (has_two) add_triangle(surface, loop[2 * k + 1], last, inner[k]);
    add_triangle(surface, last, inner[(k + 1) % m], inner[k]);
  }
  return inner;
}

}  // namespace

void fill_loop(Surface& surface, std::span<const Id> loop) {
  std::vector<Id> ring(loop.begin(), loop.end());
  while (ring.size() > largest_fan) ring = add_ring(surface, ring);
  const Id centre = add_vertex(surface, centre_of(surface, ring));
  for (std::size_t k = 0; k < ring.size(); ++k) add_triangle(surface, ring[k], ring[(k + 1) % ring.size()], centre);
}

FilledHoles fill_holes(Surface& surface) {
  const std::vector<Id> opposite = opposite_sides(surface.triangles, surface.positions.size());
  std::vector<Id> before;  // by vertex at a border: the one that the border comes from
  std::vector<Id> starts;
  for (Id side = 0; side < opposite.size(); ++side) {
    if (opposite[side] != no_id) continue;
    before.resize(surface.positions.size(), no_id);
    before[end_of(surface.triangles, side)] = start_of(surface.triangles, side);
    starts.push_back(start_of(surface.triangles, side));
  }
  FilledHoles filled;
  const std::size_t triangles = surface.triangles.size();
  for (const Id start : starts) {
    std::vector<Id> loop;
    for (Id v = start; before[v] != no_id;) {
      loop.push_back(v);
      const Id next = before[v];
      before[v] = no_id;
      v = next;
    }
    if (loop.empty()) continue;
    fill_loop(surface, loop);
    ++filled.loops;
  }
  filled.triangles = surface.triangles.size() - triangles;
  return filled;
}

}  // namespace lodestone::spherical
