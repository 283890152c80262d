#include "core/spherical/topology/fill_holes.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

namespace lodestone::spherical {
namespace {

constexpr std::size_t largest_fan = 12;
// Rings of half the vertices are three triangles for each vertex of the loop: too many for a long loop that is nearly
// all there is of the surface.
constexpr std::size_t long_loop = 1000, long_step = 6;

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

// Joins a loop to a smoother one inside with one vertex for every `step`, which is returned.
std::vector<Id> add_ring(Surface& surface, const std::vector<Id>& loop, std::size_t step) {
  const std::size_t n = loop.size(), m = (n + step - 1) / step;
  const Vec3d centre = centre_of(surface, loop);
  const double kept = 1 - std::min(0.5, static_cast<double>(step) * std::numbers::pi / static_cast<double>(n));
  std::vector<Id> inner;
  for (std::size_t k = 0; k < m; ++k) {
    const auto point = [&](std::size_t i) { return surface.positions[loop[(step * k + i) % n]]; };
    Vec3d sum = 0.5 * point(0);
    for (std::size_t i = 1; i < step; ++i) sum = sum + point(i);
    const Vec3d mean = (1.0 / static_cast<double>(step)) * (sum + 0.5 * point(step));
    inner.push_back(add_vertex(surface, centre + kept * (mean - centre)));
  }
  for (std::size_t k = 0; k < m; ++k) {
    const std::size_t end = std::min(step * (k + 1), n);
    for (std::size_t i = step * k; i < end; ++i) add_triangle(surface, loop[i], loop[(i + 1) % n], inner[k]);
    add_triangle(surface, loop[end % n], inner[(k + 1) % m], inner[k]);
  }
  return inner;
}

}  // namespace

void fill_loop(Surface& surface, std::span<const Id> loop) {
  std::vector<Id> ring(loop.begin(), loop.end());
  const std::size_t most = std::max(long_loop, surface.positions.size() / 4);
  while (ring.size() > largest_fan) ring = add_ring(surface, ring, ring.size() > most ? long_step : 2);
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
