// Costs of collapses, and tests whether the surface allows them, for all neighbours of a vertex at once, in lanes.
#pragma once

#include <algorithm>
#include <bit>

#include "core/math/lanes/star_lanes.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

inline constexpr float min_cosine = 0.5f;  // of the angle that a triangle may turn by
inline constexpr float stiffness = 1e-6f;  // of a short edge where nothing else decides

// Undivided sums rank by what is added to the error of the whole mesh, means by the distance alone: between them.
inline float rank_scale(float weight) { return 1 / std::max(std::sqrt(weight * std::sqrt(weight)), 1e-30f); }

inline namespace LODESTONE_LANES {

inline Int8 ids8(Id id) { return ints8(static_cast<std::int32_t>(id)); }

// Lanes after the last neighbour hold the vertex itself.
template <int G>
[[gnu::always_inline]] inline Star<G> load_star(const AlignedPoint* points, const Ring& ring, Id v) {
  static constexpr std::int32_t places[8]{0, 1, 2, 3, 4, 5, 6, 7};
  const Int8 place = load<Int8>(places);
  alignas(32) Id ids[8 * G];
  for (int g = 0; g < G; ++g) {
    const Int8 used = place < ints8(static_cast<int>(ring.size) - 8 * g);
    const Int8 padded = select(used, load<Int8>(ring.ids + 8 * g), ids8(v));
    store(ids + 8 * g, padded);
  }
  return gather_star<G>(points, ids, points[v]);
}

// Cost that the collapse into each neighbour adds.
template <int G>
[[gnu::always_inline]] inline void star_ranks(const CentredQuadric& q, const Star<G>& star, Float8 (&ranks)[G]) {
  const Float8 stiff = all8(stiffness * q.weight), scale = all8(rank_scale(q.weight));
  for (int g = 0; g < G; ++g) {
    const Float8 &x = star.x[g], &y = star.y[g], &z = star.z[g];
    const Float8 error = quadratic_form(q, x, y, z) + all8(q.c);
    ranks[g] = max(error + stiff * (x * x + y * y + z * z), all8(0)) * scale;
  }
}

// The link condition, as in RingMesh::allows: v and its target have no neighbours in common but those after and before
// the target, and these and the target keep a fan.
template <int G>
[[nodiscard, gnu::always_inline]] inline bool joins(const RingMesh& rings, const Ring& v, std::uint32_t at) {
  const Ring& u = rings.ring(v.ids[at]);
  if (v.open == 0 && v.size < 3) return false;
  unsigned common = 0, again = 0;  // where the surface was cut two vertices may share several edges
  for (int g = 0; g < G; ++g) {
    const Int8 ids = load<Int8>(v.ids + 8 * g);
    Int8 times{};  // the number of occurrences in the ring of the target
    for (std::uint32_t i = 0; i < u.size; ++i) times = times - (ids == ids8(u.ids[i]));
    common |= bits(ints8(0) < times) << 8 * g, again |= bits(ints8(1) < times) << 8 * g;
  }
  const unsigned all = (1u << v.size) - 1;
  if (std::popcount(common & all) != (v.open != 0 ? 1 : 2) || (again & all) != 0) return false;
  if (v.size + u.size < (v.open != 0 ? 3u : 4u) + (u.open != 0 ? 2u : 3u)) return false;
  const auto keeps_fan = [&](std::uint32_t k) {
    const Ring& side = rings.ring(v.ids[k]);
    return side.size > (side.open != 0 ? 2u : 3u);
  };
  if (v.open == 0) return keeps_fan(v.next(at)) && keeps_fan(v.previous(at));
  return keeps_fan(at == 0 ? 1 : at - 1);
}

// True if a triangle that is kept would turn by 60 degrees or more, or lose its area, with the vertex moved to
// neighbour `at`.
template <int G>
[[nodiscard, gnu::always_inline]] inline bool star_turns(const Star<G>& star, const Ring& ring, std::uint32_t at) {
  const unsigned n = ring.size, lane = at % 8;
  const int group = static_cast<int>(at / 8);
  const Float8 tx = spread(star.x[group], lane), ty = spread(star.y[group], lane), tz = spread(star.z[group], lane);
  const Star<G> next = next_around<G>(star, n);
  unsigned turned = 0;
  for (int g = 0; g < G; ++g) {
    const Float8 &ax = star.x[g], &ay = star.y[g], &az = star.z[g];
    const Float8 &bx = next.x[g], &by = next.y[g], &bz = next.z[g];
    const Float8 nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
    const Float8 cx = ax - tx, cy = ay - ty, cz = az - tz, dx = bx - tx, dy = by - ty, dz = bz - tz;
    const Float8 mx = cy * dz - cz * dy, my = cz * dx - cx * dz, mz = cx * dy - cy * dx;
    const Float8 along = nx * mx + ny * my + nz * mz, zero = all8(0);
    const Float8 size = nx * nx + ny * ny + nz * nz, size_after = mx * mx + my * my + mz * mz;
    const unsigned kept = bits(zero < along) & bits(all8(min_cosine * min_cosine) * size * size_after < along * along);
    turned |= (bits(zero < size) & ~kept) << 8 * g;
  }
  const unsigned vanish = 1u << at | 1u << (at == 0 ? n - 1 : at - 1);
  return (turned & ((1u << ring.sectors()) - 1) & ~vanish) != 0;
}

// chain_fan for at most eight triangles.
inline Shape chain_eight(const Id* start, const Id* end, std::uint32_t n, std::uint8_t* order) {
  const Int8 starts = load<Int8>(start);
  const unsigned all = (1u << n) - 1;
  std::uint8_t next[8];
  unsigned has_before = 0;
  bool clear = true;
  for (std::uint32_t k = 0; k < 8; ++k) {  // all eight, as a loop of any number ends unpredictably
    const unsigned after = bits(starts == ids8(end[k])) & (k < n ? all : 0);
    clear = clear && (after & ((after - 1) | has_before)) == 0;
    next[k] = static_cast<std::uint8_t>(std::countr_zero(after));
    has_before |= after;
  }
  return clear ? follow_fan(next, has_before, n, order) : Shape::several;
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::progressive
