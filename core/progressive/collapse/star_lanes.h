// One vertex and its neighbours in lanes: ranks, the link condition, turned triangles and first quadrics.
#pragma once

#include <algorithm>
#include <bit>

#include "core/progressive/collapse/plane_quadric.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

inline constexpr float least_cosine = 0.5f;  // of the angle that a triangle may turn by
inline constexpr float stiffness = 1e-6f;    // of a short edge where nothing else decides

// Neighbours relative to the vertex, in G groups of eight; lanes behind the last hold the vertex itself.
template <class L, int G>
struct Star {
  typename L::Float x[G], y[G], z[G];
};

template <class L, int G>
[[gnu::always_inline]] inline Star<L, G> load_star(const quadric::Point* points, const Ring& ring, Id v) {
  using Float = typename L::Float;
  Star<L, G> star;
  const quadric::Point& p = points[v];
  const Float x = Float::all(p.x), y = Float::all(p.y), z = Float::all(p.z);
  for (int g = 0; g < G; ++g) {
    alignas(32) Id ids[8];
    L::Ids::load(ring.ids + 8 * g).first(static_cast<int>(ring.size) - 8 * g, v).store(ids);
    const auto q = L::Points::gather(points, ids);
    star.x[g] = q.x - x, star.y[g] = q.y - y, star.z[g] = q.z - z;
  }
  return star;
}

// Of each lane the next one around the ring; lanes behind the ring mean nothing.
template <class L, int G>
[[gnu::always_inline]] inline void next_around(const typename L::Float (&a)[G], unsigned n,
                                               typename L::Float (&next)[G]) {
  if constexpr (G == 1) {
    next[0] = rotate(a[0], n);
  } else {
    next[0] = select(1u << 7, spread(a[1], 0), rotate(a[0], 8));
    next[1] = select(1u << (n - 9), spread(a[0], 0), rotate(a[1], 8));
  }
}

// Undivided sums rank by what is added to the error of the whole mesh, means by the distance alone: between them.
inline float rank_scale(float weight) { return 1 / std::max(std::sqrt(weight * std::sqrt(weight)), 1e-30f); }

// What the collapse into each neighbour adds: the operations of PlaneQuadric::at, in its order.
template <class L, int G>
[[gnu::always_inline]] inline void star_ranks(const PlaneQuadric& q, const Star<L, G>& star,
                                              typename L::Float (&ranks)[G]) {
  using Float = typename L::Float;
  const Float two = Float::all(2), xy = Float::all(q.xy), xz = Float::all(q.xz), yz = Float::all(q.yz);
  const Float stiff = Float::all(stiffness * q.weight), scale = Float::all(rank_scale(q.weight));
  for (int g = 0; g < G; ++g) {
    const Float &x = star.x[g], &y = star.y[g], &z = star.z[g];
    const Float error = x * (Float::all(q.xx) * x + two * (xy * y + xz * z + Float::all(q.bx))) +
                        y * (Float::all(q.yy) * y + two * (yz * z + Float::all(q.by))) +
                        z * (Float::all(q.zz) * z + two * Float::all(q.bz)) + Float::all(q.c);
    ranks[g] = max(error + stiff * (x * x + y * y + z * z), Float::all(0)) * scale;
  }
}

// The link condition, as RingMesh::allows has it: v and its target have no neighbours in common but those behind and
// before the target, and these and the target keep a fan.
template <class L, int G>
[[nodiscard, gnu::always_inline]] inline bool joins(const RingMesh& rings, const Ring& v, std::uint32_t at) {
  const Ring& u = rings.ring(v.ids[at]);
  if (v.open == 0 && v.size < 3) return false;
  unsigned common = 0, again = 0;  // where the surface was cut two vertices may share several edges
  for (int g = 0; g < G; ++g) {
    const Matches matches = L::Ids::load(v.ids + 8 * g).among(u.ids, u.size);
    common |= matches.once << 8 * g, again |= matches.again << 8 * g;
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

// Whether a triangle that stays would turn by 60 degrees or more, or lose its area, with the vertex moved to neighbour
// `at`.
template <class L, int G>
[[nodiscard, gnu::always_inline]] inline bool star_turns(const Star<L, G>& star, const Ring& ring, std::uint32_t at) {
  using Float = typename L::Float;
  const unsigned n = ring.size, lane = at % 8;
  const int group = static_cast<int>(at / 8);
  const Float tx = spread(star.x[group], lane), ty = spread(star.y[group], lane), tz = spread(star.z[group], lane);
  Float next_x[G], next_y[G], next_z[G];
  next_around<L, G>(star.x, n, next_x);
  next_around<L, G>(star.y, n, next_y);
  next_around<L, G>(star.z, n, next_z);
  unsigned turned = 0;
  for (int g = 0; g < G; ++g) {
    const Float &ax = star.x[g], &ay = star.y[g], &az = star.z[g];
    const Float &bx = next_x[g], &by = next_y[g], &bz = next_z[g];
    const Float nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
    const Float cx = ax - tx, cy = ay - ty, cz = az - tz, dx = bx - tx, dy = by - ty, dz = bz - tz;
    const Float mx = cy * dz - cz * dy, my = cz * dx - cx * dz, mz = cx * dy - cy * dx;
    const Float along = nx * mx + ny * my + nz * mz;
    const Float size = nx * nx + ny * ny + nz * nz, size_after = mx * mx + my * my + mz * mz;
    const Float zero = Float::all(0);
    const unsigned stays =
        less(zero, along) & less(Float::all(least_cosine * least_cosine) * size * size_after, along * along);
    turned |= (less(zero, size) & ~stays) << 8 * g;
  }
  const unsigned vanish = 1u << at | 1u << (at == 0 ? n - 1 : at - 1);
  return (turned & ((1u << ring.sectors()) - 1) & ~vanish) != 0;
}

// chain_fan for at most eight triangles.
template <class L>
Shape chain_eight(const Id* start, const Id* end, std::uint32_t n, std::uint8_t* order) {
  const auto starts = L::Ids::load(start);
  const unsigned all = (1u << n) - 1;
  std::uint8_t next[8];
  unsigned has_before = 0;
  bool clear = true;
  for (std::uint32_t k = 0; k < n; ++k) {
    const unsigned behind = starts.equal(end[k]) & all;
    clear = clear && (behind & ((behind - 1) | has_before)) == 0;
    next[k] = static_cast<std::uint8_t>(std::countr_zero(behind));
    has_before |= behind;
  }
  return clear ? follow_fan(next, has_before, n, order) : Shape::several;
}

// The quadric of a vertex whose triangles bring nothing but their planes: neither borders nor seams.
template <class L>
[[gnu::always_inline]] inline PlaneQuadric closed_star_quadric(const Star<L, 1>& star, unsigned n) {
  using Float = typename L::Float;
  Float next_x[1], next_y[1], next_z[1];
  next_around<L, 1>(star.x, n, next_x);
  next_around<L, 1>(star.y, n, next_y);
  next_around<L, 1>(star.z, n, next_z);
  const Float &ax = star.x[0], &ay = star.y[0], &az = star.z[0], &bx = next_x[0], &by = next_y[0], &bz = next_z[0];
  const Float nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx, zero = Float::all(0);
  const Float size = sqrt(nx * nx + ny * ny + nz * nz);
  const unsigned real = less(zero, size) & ((1u << n) - 1);
  const Float per = select(real, Float::all(0.5f) / size, zero);  // area times the square of 1 / size
  const Float area = select(real, Float::all(0.5f) * size, zero);
  const Float px = per * nx, py = per * ny;
  Float rows[8]{px * nx, px * ny, px * nz, py * ny, py * nz, per * nz * nz, area, zero};
  transpose(rows);
  const Float sum = ((rows[0] + rows[4]) + (rows[1] + rows[5])) + ((rows[2] + rows[6]) + (rows[3] + rows[7]));
  PlaneQuadric q{};
  sum.store(&q.xx);
  return q;
}

}  // namespace lodestone::progressive
