// A vertex that has come up in the queue, what its collapses would cost, and what they do to quadrics and members.
#pragma once

#include <cmath>
#include <limits>

#include "core/simplify/quadric/star.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// More than a few roundings take off.
inline constexpr float rounded_up = 1 + 1e-6f;
// Buckets that a cost may have risen by since its vertex was queued: a quarter of it. Twice as many are a little faster
// and make larger maxima, one is 3 % slower.
inline constexpr unsigned patience = 4;
inline constexpr unsigned turn_front = 16;  // lanes in front, for loads that begin early

template <int G>
struct Candidate {
  Star<G> star;
  Float8 error[G];             // at each target
  Id16 ring;                   // as it was when the errors were computed
  Id around[turn_front + 32];  // the ring twice from turn_front on: it can be read from any neighbour on
  Id v;
  unsigned allowed;    // lanes that are left
  unsigned near;       // lanes known to be within the bound of every member
  unsigned lane;       // the cheapest of the allowed; 32 or more if none is left
  unsigned bucket;     // of its cost
  std::int64_t scale;  // what the errors are divided by, as a logarithm
};

// Lanes that every member of v reaches.
template <int G>
[[nodiscard, gnu::always_inline]] inline unsigned within_bound(const Block& b, Id v, const Star<G>& star) {
  Float8 farthest[G];
  for (int g = 0; g < G; ++g) farthest[g] = star.x[g] * star.x[g] + star.y[g] * star.y[g] + star.z[g] * star.z[g];
  for (Id m = b.a.member[v].next; m != none; m = b.a.member[m].next) {
    const Vec3f offset = b.a.point[m] - b.a.point[v];
    const Float8 x = all8(offset.x), y = all8(offset.y), z = all8(offset.z);
    for (int g = 0; g < G; ++g) {
      const Float8 dx = star.x[g] - x, dy = star.y[g] - y, dz = star.z[g] - z;
      farthest[g] = max(dx * dx + dy * dy + dz * dz, farthest[g]);
    }
  }
  unsigned lanes = 0;
  for (int g = 0; g < G; ++g) lanes |= bits(farthest[g] <= all8(b.squared_bound)) << (8 * g);
  return lanes;
}

// The part of the ring that a candidate needs. Lane by lane: the compiler copies an aggregate in halves, and the loads
// that follow would wait for them.
template <int G>
[[gnu::always_inline]] inline void survey(const Block& b, Id v, unsigned n, Candidate<G>& c) {
  const Ring& ring = b.a.ring[v];
  const Star<G> star = load_star<G>(b, v);
  for (int g = 0; g < G; ++g) {
    c.star.x[g] = star.x[g], c.star.y[g] = star.y[g], c.star.z[g] = star.z[g];
  }
  c.v = v;
  c.ring = Id16::load(ring.lane);
  c.allowed = ring.has(open) ? 1u | 1u << (n - 1) : (1u << n) - 1;
  if (ring.has(seamed)) c.allowed &= b.seams->lanes(v, ring, n);
}

// The errors, at its targets, of what has collapsed into the candidate. The target's own error and area stay out of it:
// a large flat target would hide what the tip of a small feature loses. Most targets are near enough for every member
// by the triangle inequality alone; the others are looked at only if they are wanted.
template <int G>
[[gnu::always_inline]] inline void rate(const Block& b, Candidate<G>& c) {
  const Body& body = b.a.body[c.v];
  const float room = std::max(b.bound - body.reach, 0.0f);
  c.near = 0;
  c.scale = scale_of(body.weight);
  for (int g = 0; g < G; ++g) {
    const Float8 &x = c.star.x[g], &y = c.star.y[g], &z = c.star.z[g];
    c.error[g] = quadratic_form(body, x, y, z) + all8(body.c);
    c.near |= bits(x * x + y * y + z * z <= all8(room * room)) << (8 * g);
  }
}

// The cheapest of the allowed lanes.
template <int G>
[[gnu::always_inline]] inline void choose(Candidate<G>& c) {
  const Float8 infinite = all8(std::numeric_limits<float>::infinity());
  float best = lowest(select(c.allowed, c.error[0], infinite));
  if constexpr (G == 2) {
    const float second = lowest(select(c.allowed >> 8, c.error[1], infinite));
    best = second < best ? second : best;
  }
  unsigned lanes = 0;
  for (int g = 0; g < G; ++g) lanes |= bits(c.error[g] == all8(best)) << (8 * g);
  c.lane = static_cast<unsigned>(std::countr_zero(lanes & c.allowed));
  c.bucket = bucket_of(best, c.scale);
}

// The quadric of v moved to u = v + t and added to that of u; the members of v follow those of u.
[[gnu::always_inline]] inline void merge_bodies(Block& b, Id v, Id u, Vec3f t) {
  const Body& q = b.a.body[v];
  Body& sum = b.a.body[u];
  const float ax = q.xx * t.x + q.xy * t.y + q.xz * t.z;
  const float ay = q.xy * t.x + q.yy * t.y + q.yz * t.z;
  const float az = q.xz * t.x + q.yz * t.y + q.zz * t.z;
  const float error = q.c + (t.x * (ax + 2 * q.bx) + t.y * (ay + 2 * q.by) + t.z * (az + 2 * q.bz));
  const Float8 moved = select(1u << 7, all8(error > 0 ? error : 0), load<Float8>(&q.xx));
  store(&sum.xx, load<Float8>(&sum.xx) + moved);
  sum.bx += q.bx + ax, sum.by += q.by + ay, sum.bz += q.bz + az;
  sum.reach = std::max(sum.reach, (std::sqrt(t.x * t.x + t.y * t.y + t.z * t.z) + q.reach) * rounded_up);
  b.a.member[b.a.member[u].tail].next = v;
  b.a.member[u].tail = b.a.member[v].tail;
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
