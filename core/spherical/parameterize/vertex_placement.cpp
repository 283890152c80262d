#include "core/spherical/parameterize/vertex_placement.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/math/orientation.h"

namespace lodestone::spherical {
namespace {

using progressive::Id;
using progressive::Ring;

Vec3d unit(Vec3d v) {
  const double size = length(v);
  return size > 0 ? (1 / size) * v : Vec3d{};
}

bool is_inside(Vec3d p, const Ring& ring, std::span<const AlignedPoint4d> directions) {
  for (std::uint32_t k = 0; k < ring.size; ++k)
    if (orientation(p, directions[ring.ids[k]].point(), directions[ring.ids[ring.next(k)]].point()) <= 0) return false;
  return true;
}

}  // namespace

bool place_vertex(Id vertex, Id target, const Ring& ring, std::span<AlignedPoint4d> directions) {
  constexpr int most_halvings = 60;
  const auto at = [&](std::uint32_t k) { return directions[ring.ids[k]].point(); };
  const std::uint32_t place = ring.find(target), next = ring.next(place), previous = ring.previous(place);
  const Vec3d u = at(place), towards = unit(cross(u, at(next))) + unit(cross(at(previous), u));
  double way = 0.5 / std::max(length(towards), 1e-100);
  for (std::uint32_t k = next; k != previous; k = ring.next(k)) {
    const Vec3d plane = cross(at(k), at(ring.next(k)));
    const double slope = dot(towards, plane);
    if (slope < 0) way = std::min(way, 0.5 * std::max(dot(u, plane), 0.0) / -slope);
  }
  for (int trials = 0; trials < most_halvings; ++trials, way /= 2) {
    const Vec3d p = snapped(unit(u + way * towards));
    if (!is_inside(p, ring, directions)) continue;
    directions[vertex] = p;
    return true;
  }
  return false;
}

std::uint8_t free_colour(const Ring& ring, std::span<const std::uint8_t> colours) {
  std::array<std::uint64_t, 4> taken{};
  for (const Id x : ring.neighbours()) taken[colours[x] / 64] |= std::uint64_t{1} << (colours[x] % 64);
  int colour = 0;
  for (const std::uint64_t word : taken) {
    colour += std::countr_one(word);
    if (word != ~std::uint64_t{0}) break;
  }
  return static_cast<std::uint8_t>(std::min<int>(colour, absent_colour));
}

}  // namespace lodestone::spherical
