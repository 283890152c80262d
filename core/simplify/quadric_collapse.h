// The queue and the collapses.
#pragma once

#include <bit>
#include <limits>

#include "core/simplify/quadric_kernel.h"

namespace lodestone::quadric {

template <class L>
unsigned BlockKernel<L>::bucket_of(float cost) {
  return cost > 0 ? std::bit_cast<std::uint32_t>(cost) >> bucket_shift : 0;
}

template <class L>
void BlockKernel<L>::push(Id v, unsigned bucket) {
  a_.next_in_bucket[v] = a_.bucket[bucket];
  a_.bucket[bucket] = v;
}

// A vertex is evaluated when it comes up, not when its surroundings change: costs mostly rise, and one that has risen
// by more than a bucket goes back.
template <class L>
void BlockKernel<L>::collapse_to_target() {
  for (unsigned b = 0; b < bucket_count; ++b) {
    while (a_.bucket[b] != none) {
      if (live_ <= input_.target_triangles) return;
      const Id v = a_.bucket[b];
      a_.bucket[b] = a_.next_in_bucket[v];
      prefetch_next(a_.next_in_bucket[v]);
      const unsigned n = degree(v);
      if (n <= 8) {
        visit<1>(v, n, b);
      } else {
        visit<2>(v, n, b);
      }
    }
  }
}

// Most of a collapse is waiting for the second-level cache; the chain of the bucket says early what comes next.
template <class L>
void BlockKernel<L>::prefetch_next(Id v) const {
  const Ring& ring = a_.ring[v];
  for (int k = 0; k < 6; ++k) {
    __builtin_prefetch(&a_.point[ring.lane[k]]);
    __builtin_prefetch(&a_.ring[ring.lane[k]]);
  }
  const Id after = a_.next_in_bucket[v];
  __builtin_prefetch(&a_.body[after]);
  __builtin_prefetch(&a_.ring[after]);
  __builtin_prefetch(&a_.point[after]);
}

// Lanes that every member of v reaches.
template <class L>
template <int G>
inline unsigned BlockKernel<L>::within_bound(Id v, const Star<G>& star) const {
  Float farthest[G];
  for (int g = 0; g < G; ++g) farthest[g] = star.x[g] * star.x[g] + star.y[g] * star.y[g] + star.z[g] * star.z[g];
  const Point& p = a_.point[v];
  for (Id m = a_.member[v].next; m != none; m = a_.member[m].next) {
    const Point& q = a_.point[m];
    const Float x = Float::all(q.x - p.x), y = Float::all(q.y - p.y), z = Float::all(q.z - p.z);
    for (int g = 0; g < G; ++g) {
      const Float dx = star.x[g] - x, dy = star.y[g] - y, dz = star.z[g] - z;
      farthest[g] = max(dx * dx + dy * dy + dz * dz, farthest[g]);
    }
  }
  unsigned bits = 0;
  for (int g = 0; g < G; ++g) bits |= not_above(farthest[g], Float::all(squared_bound_)) << (8 * g);
  return bits;
}

// Lane of the least cost among the allowed; 32 where none is left.
template <class L>
template <int G>
inline unsigned BlockKernel<L>::cheapest(const Float (&cost)[G], unsigned allowed) {
  const Float infinite = Float::all(std::numeric_limits<float>::infinity());
  float best = lowest(select(allowed, cost[0], infinite));
  if constexpr (G == 2) {
    const float second = lowest(select(allowed >> 8, cost[1], infinite));
    best = second < best ? second : best;
  }
  unsigned lanes = 0;
  for (int g = 0; g < G; ++g) lanes |= equal(cost[g], best) << (8 * g);
  return static_cast<unsigned>(std::countr_zero(lanes & allowed));
}

template <class L>
template <int G>
void BlockKernel<L>::visit(Id v, unsigned n, unsigned bucket) {
  Ring& ring = a_.ring[v];
  const Body& body = a_.body[v];
  const Star<G> star = load_star<G>(v);
  const bool is_open = ring.has(open);
  unsigned allowed = is_open ? 1u | 1u << (n - 1) : (1u << n) - 1;
  if (ring.has(seamed)) allowed &= seams_->lanes(v, ring, n);
  allowed &= within_bound<G>(v, star);
  Float cost[G];
  for (int g = 0; g < G; ++g) {
    const Float error = quadratic_form(body, star.x[g], star.y[g], star.z[g]) + Float::all(body.error) +
                        upper_half(star.error_weight[g]);
    const Float weight = Float::all(body.weight) + lower_half(star.error_weight[g]);
    cost[g] = max(error, Float::all(0)) / weight;
  }
  unsigned lane = cheapest<G>(cost, allowed);
  if (lane < 32) {
    __builtin_prefetch(&a_.body[ring.lane[lane]]);
    const auto cost_of = [&](unsigned k) { return G == 1 || k < 8 ? pick(cost[0], k) : pick(cost[G - 1], k - 8); };
    const auto shift_to = [&](unsigned k) {
      const int g = G == 1 || k < 8 ? 0 : G - 1;
      const unsigned at = k - 8 * static_cast<unsigned>(g);
      return Shift{pick(star.x[g], at), pick(star.y[g], at), pick(star.z[g], at)};
    };
    unsigned now = bucket_of(cost_of(lane));
    if (now > bucket + 1) return push(v, now);
    const Faces<G> faces = faces_of<G>(star, n);
    const unsigned real = (1u << (is_open ? n - 1 : n)) - 1;
    do {
      const Shift t = shift_to(lane);
      // The triangles on both sides of the edge vanish.
      const unsigned vanish = 1u << lane | 1u << (lane == 0 ? n - 1 : lane - 1);
      if ((flipped<G>(faces, t) & real & ~vanish) == 0 && joinable(v, n, lane)) return collapse(v, n, lane, t, bucket);
      allowed &= ~(1u << lane);
      lane = cheapest<G>(cost, allowed);
      if (lane >= 32) break;
      now = bucket_of(cost_of(lane));
      if (now > bucket + 1) return push(v, now);
    } while (true);
  }
  ring.lane[flags_lane] = static_cast<Id>(ring.lane[flags_lane] & ~queued);
}

// The link condition: v and its target have no other neighbours in common than the triangles at their edge say.
template <class L>
bool BlockKernel<L>::joinable(Id v, unsigned n, unsigned lane) const {
  const Ring& ring = a_.ring[v];
  const Ring& target = a_.ring[ring.lane[lane]];
  if (target.has(bare) || target.has(sealed)) return false;
  if (ring.has(seamed) && !seams_->lets(v, ring.lane[lane])) return false;
  const Ids target_ids = Ids::load(target.lane);
  const unsigned m = target_ids.find(none);
  const bool is_open = ring.has(open);
  const unsigned joined = m + n - (is_open ? 3 : 4);
  if (joined > ring_capacity) return false;
  if (target_ids.count_common(m, Ids::load(ring.lane), n) != (is_open ? 1u : 2u)) return false;
  if (!is_open) {
    if (target.has(pile) ? n == 3 : !target.has(open) && joined < 3) return false;  // a triangle would be doubled
  } else if (n == 2 && (target.has(pile) || m < 3)) {
    return false;  // an ear whose last edge carries nothing else
  }
  return !target.has(locked) || !makes_locked_chord(ring, n, lane);
}

// A new edge, or triangle, of locked vertices only: the block on the other side could make it too.
template <class L>
bool BlockKernel<L>::makes_locked_chord(const Ring& ring, unsigned n, unsigned lane) const {
  // The neighbours that v and the target have in common; on the border there is one.
  const bool is_open = ring.has(open);
  const unsigned before = lane > 0 ? lane - 1 : is_open ? n : n - 1;
  const unsigned after = lane + 1 < n ? lane + 1 : is_open ? n : 0;
  unsigned count = 0;
  for (unsigned k = 0; k < n; ++k) {
    if (k == lane || !a_.ring[ring.lane[k]].has(locked)) continue;
    ++count;
    if (k != before && k != after) return true;
  }
  return n == 3 && count == 2;
}

// A vertex without a valid target left the queue; now that its ring is another one it gets a new chance.
template <class L>
void BlockKernel<L>::requeue(Id v, unsigned bucket) {
  Id& flags = a_.ring[v].lane[flags_lane];
  if ((flags & (movable | queued)) != movable) return;
  flags |= queued;
  push(v, bucket);
}

template <class L>
void BlockKernel<L>::merge_bodies(Id v, Id u, Shift t) {
  const Body& q = a_.body[v];
  Body& sum = a_.body[u];
  // q moved from v to u = v + t.
  const float ax = q.xx * t.x + q.xy * t.y + q.xz * t.z;
  const float ay = q.xy * t.x + q.yy * t.y + q.yz * t.z;
  const float az = q.xz * t.x + q.yz * t.y + q.zz * t.z;
  const float error = q.error + (t.x * (ax + 2 * q.bx) + t.y * (ay + 2 * q.by) + t.z * (az + 2 * q.bz));
  sum.xx += q.xx, sum.xy += q.xy, sum.xz += q.xz;
  sum.yy += q.yy, sum.yz += q.yz, sum.zz += q.zz;
  sum.bx += q.bx + ax, sum.by += q.by + ay, sum.bz += q.bz + az;
  sum.error += error > 0 ? error : 0;
  sum.weight += q.weight;
  a_.member[a_.member[u].tail].next = v;
  a_.member[u].tail = a_.member[v].tail;
  publish(sum, a_.point[u]);
}

template <class L>
void BlockKernel<L>::collapse(Id v, unsigned n, unsigned lane, Shift t, unsigned bucket) {
  const Ring& ring = a_.ring[v];
  const Id u = ring.lane[lane];
  const bool is_open = ring.has(open);
  if (seams_ != nullptr) seams_->collapse(v, u, a_);
  // The neighbours behind the target, in order. The first and the last of them are neighbours of u already; on the
  // border only one of them is.
  const Ids behind = Ids::load(ring.lane).rotated(lane + 1 < n ? lane + 1 : 0, n);
  const unsigned first = is_open && lane != 0 ? 0 : 1, last = is_open && lane == 0 ? n - 1 : n - 2;
  alignas(32) Id others[16];
  behind.store(others);

  Ring& target = a_.ring[u];
  const Ids target_ids = Ids::load(target.lane);
  target_ids.spliced(target_ids.find(v), behind, first, last - first).store(target.lane);
  requeue(u, bucket);

  const auto drop = [&](Id x) {
    Ring& other = a_.ring[x];
    if (const unsigned place = Ids::load(other.lane).find(v); place < 16) Ids::without(other, place).store(other.lane);
    requeue(x, bucket);
  };
  if (first == 1) drop(others[0]);
  for (unsigned k = first; k < last; ++k) {
    Ring& other = a_.ring[others[k]];
    Ids::load(other.lane).replace(v, u).store(other.lane);
    requeue(others[k], bucket);
  }
  if (last == n - 2) drop(others[n - 2]);
  a_.ring[v].lane[flags_lane] = flags_base | gone;
  merge_bodies(v, u, t);
  live_ -= is_open ? 1 : 2;
}

}  // namespace lodestone::quadric
