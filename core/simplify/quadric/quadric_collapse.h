// The queue and the collapses.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

// A cost is an error over weight^(3/4): between the sum of the squared distances, which asks what a collapse adds to
// the error of the whole mesh, and their mean, which knows no difference between a large star and a small one (decision
// 0013). Buckets are logarithms, and so are the bits of a float, nearly: there is nothing to be divided.
template <class L>
inline std::int64_t BlockKernel<L>::scale_of(float weight) {
  const auto over_one = std::int64_t{std::bit_cast<std::uint32_t>(weight)} - 0x3f80'0000;
  return over_one - (over_one >> 2);
}

template <class L>
inline unsigned BlockKernel<L>::bucket_of(float error, std::int64_t scale) {
  if (!(error > 0)) return 0;
  const std::int64_t bits = std::int64_t{std::bit_cast<std::uint32_t>(error)} - scale;
  return static_cast<unsigned>(std::clamp<std::int64_t>(bits, 0, 0x7fff'ffff) >> bucket_shift);
}

template <class L>
void BlockKernel<L>::push(Id v, unsigned bucket) {
  a_.next_in_bucket[v] = a_.bucket[bucket];
  a_.bucket[bucket] = v;
}

// A vertex is evaluated when it comes up, not when its surroundings change: costs mostly rise, and one that has risen
// by more than `patience` goes back. Several come up together and are evaluated side by side, step by step, since each
// step of one waits for the step before; a collapse among them may leave another to be evaluated again.
template <class L>
void BlockKernel<L>::collapse_to_target() {
  // A pile may take more than two triangles with it: its third of those that it has.
  const std::size_t target = triangles_to_keep(input_, movable_ + pile_corners_ / 6);
  Id next[batch_size];
  Candidate<1> batch[batch_size];
  for (unsigned b = 0; b < bucket_count; ++b) {
    for (unsigned count = take(b, next); count > 0;) {
      const unsigned now = count;
      // Of a crowded vertex this is half the truth, which nobody asks for.
      for (unsigned i = 0; i < now; ++i) survey(next[i], std::min(degree(next[i]), 8u), batch[i]);
      for (unsigned i = 0; i < now; ++i) rate(batch[i]);
      for (unsigned i = 0; i < now; ++i) choose(batch[i]);
      count = take(b, next);  // already, so that memory has time
      for (unsigned i = 0; i < now; ++i) {
        if (live_ <= target) return;
        Candidate<1>& c = batch[i];
        const unsigned n = degree(c.v);
        if (a_.ring[c.v].has(pile)) {
          visit_pile(c.v, b);
          continue;
        }
        if (n > 8) {
          visit_crowded(c.v, n, b);
          continue;
        }
        if (!Ids::load(a_.ring[c.v].lane).same(c.ring)) survey(c.v, n, c), rate(c), choose(c);
        decide(n, c, b);
      }
    }
  }
}

template <class L>
void BlockKernel<L>::visit_crowded(Id v, unsigned n, unsigned bucket) {
  Candidate<2> c;
  survey(v, n, c), rate(c), choose(c);
  decide(n, c, bucket);
}

// The next vertices of a bucket.
template <class L>
unsigned BlockKernel<L>::take(unsigned bucket, Id (&batch)[batch_size]) {
  unsigned count = 0;
  Id v = a_.bucket[bucket];
  for (; v != none && count < batch_size; v = a_.next_in_bucket[v]) {
    batch[count++] = v;
    __builtin_prefetch(&a_.ring[v]);
    __builtin_prefetch(&a_.body[v]);
    __builtin_prefetch(&a_.point[v]);
  }
  a_.bucket[bucket] = v;
  return count;
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

// What the candidate needs of the ring. Lane by lane: the compiler copies an aggregate in halves, and the loads that
// follow would wait for them.
template <class L>
template <int G>
inline void BlockKernel<L>::survey(Id v, unsigned n, Candidate<G>& c) const {
  const Ring& ring = a_.ring[v];
  const Star<G> star = load_star<G>(v);
  for (int g = 0; g < G; ++g) {
    c.star.x[g] = star.x[g], c.star.y[g] = star.y[g], c.star.z[g] = star.z[g];
  }
  c.v = v;
  c.ring = Ids::load(ring.lane);
  c.ring.store(c.around + turn_front);
  c.ring.store(c.around + turn_front + n);
  c.allowed = ring.has(open) ? 1u | 1u << (n - 1) : (1u << n) - 1;
  if (ring.has(seamed)) c.allowed &= seams_->lanes(v, ring, n);
}

// The errors at its targets, of what has collapsed into the candidate. The target's own error and area stay
// out of it: a large flat target would hide what the tip of a small feature loses. Most targets are near enough for
// every member by the triangle inequality alone; the others are looked at only if they are wanted.
template <class L>
template <int G>
inline void BlockKernel<L>::rate(Candidate<G>& c) const {
  const Body& body = a_.body[c.v];
  const float room = std::max(bound_ - body.reach, 0.0f);
  c.near = 0;
  c.scale = scale_of(body.weight);
  for (int g = 0; g < G; ++g) {
    const Float &x = c.star.x[g], &y = c.star.y[g], &z = c.star.z[g];
    c.error[g] = quadratic_form(body, x, y, z) + Float::all(body.error);
    c.near |= not_above(x * x + y * y + z * z, Float::all(room * room)) << (8 * g);
  }
}

// The cheapest of the allowed lanes.
template <class L>
template <int G>
inline void BlockKernel<L>::choose(Candidate<G>& c) {
  const Float infinite = Float::all(std::numeric_limits<float>::infinity());
  float best = lowest(select(c.allowed, c.error[0], infinite));
  if constexpr (G == 2) {
    const float second = lowest(select(c.allowed >> 8, c.error[1], infinite));
    best = second < best ? second : best;
  }
  unsigned lanes = 0;
  for (int g = 0; g < G; ++g) lanes |= equal(c.error[g], best) << (8 * g);
  c.lane = static_cast<unsigned>(std::countr_zero(lanes & c.allowed));
  c.bucket = bucket_of(best, c.scale);
}

// Collapses the candidate into the cheapest target that can be had for the price of the bucket; where there is none it
// goes back, or leaves the queue.
template <class L>
template <int G>
inline void BlockKernel<L>::decide(unsigned n, Candidate<G>& c, unsigned bucket) {
  Ring& ring = a_.ring[c.v];
  if (c.lane < 32) {
    if (c.bucket > bucket + patience) return push(c.v, c.bucket);
    __builtin_prefetch(&a_.body[ring.lane[c.lane]]);
    const Faces<G> faces = faces_of<G>(c.star, n);
    const unsigned real = (1u << (ring.has(open) ? n - 1 : n)) - 1;
    do {
      const unsigned lane = c.lane;
      if ((c.near >> lane & 1) == 0) c.allowed &= c.near = within_bound<G>(c.v, c.star);
      if ((c.allowed >> lane & 1) != 0) {
        const int g = G == 1 || lane < 8 ? 0 : G - 1;
        const unsigned k = lane - 8 * static_cast<unsigned>(g);
        const Shift t{pick(c.star.x[g], k), pick(c.star.y[g], k), pick(c.star.z[g], k)};
        // The triangles on both sides of the edge vanish.
        const unsigned vanish = 1u << lane | 1u << (lane == 0 ? n - 1 : lane - 1);
        if ((flipped<G>(faces, t) & real & ~vanish) == 0 && joinable(c.v, n, lane))
          return collapse(c.v, n, lane, c.around + turn_front + (lane + 1 < n ? lane + 1 : 0), t, bucket);
        c.allowed &= ~(1u << lane);
      }
      choose(c);
      if (c.lane >= 32) break;
      if (c.bucket > bucket + patience) return push(c.v, c.bucket);
    } while (true);
  }
  ring.lane[flags_lane] = static_cast<Id>(ring.lane[flags_lane] & ~queued);
}

// The link condition: v and its target have no other neighbours in common than the triangles at their edge say.
template <class L>
inline bool BlockKernel<L>::joinable(Id v, unsigned n, unsigned lane) const {
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

// A vertex without a valid target left the queue; now that its ring is to be another one it gets a new chance. Comes
// before the ring is stored, so that the flags need not wait for that.
template <class L>
void BlockKernel<L>::requeue(Id v, unsigned bucket) {
  Id& flags = a_.ring[v].lane[flags_lane];
  if ((flags & (movable | queued)) != movable) return;
  flags |= queued;
  push(v, bucket);
}

// The quadric of v moved to u = v + t and added to that of u; the members of v follow those of u.
template <class L>
inline void BlockKernel<L>::merge_bodies(Id v, Id u, Shift t) {
  const Body& q = a_.body[v];
  Body& sum = a_.body[u];
  const float ax = q.xx * t.x + q.xy * t.y + q.xz * t.z;
  const float ay = q.xy * t.x + q.yy * t.y + q.yz * t.z;
  const float az = q.xz * t.x + q.yz * t.y + q.zz * t.z;
  const float error = q.error + (t.x * (ax + 2 * q.bx) + t.y * (ay + 2 * q.by) + t.z * (az + 2 * q.bz));
  const Float moved = select(1u << 7, Float::all(error > 0 ? error : 0), Float::load(&q.xx));
  (Float::load(&sum.xx) + moved).store(&sum.xx);
  sum.bx += q.bx + ax, sum.by += q.by + ay, sum.bz += q.bz + az;
  sum.reach = std::max(sum.reach, (std::sqrt(t.x * t.x + t.y * t.y + t.z * t.z) + q.reach) * rounded_up);
  a_.member[a_.member[u].tail].next = v;
  a_.member[u].tail = a_.member[v].tail;
}

// `behind` are the neighbours behind the target, in order. The first and the last of them are neighbours of the target
// already; on the border only one of them is.
template <class L>
inline void BlockKernel<L>::collapse(Id v, unsigned n, unsigned lane, const Id* behind, Shift t, unsigned bucket) {
  const Ring& ring = a_.ring[v];
  const Id u = ring.lane[lane];
  const bool is_open = ring.has(open);
  if (seams_ != nullptr) seams_->collapse(v, u, a_);
  const unsigned first = is_open && lane != 0 ? 0 : 1, last = is_open && lane == 0 ? n - 1 : n - 2;

  requeue(u, bucket);
  Ring& target = a_.ring[u];
  Ids::spliced(target, Ids::load(target.lane).find(v), behind + first, last - first).store(target.lane);

  const auto drop = [&](Id x) {
    requeue(x, bucket);
    Ring& other = a_.ring[x];
    const Ids ids = Ids::load(other.lane);
    if (const unsigned place = ids.find(v); place < 16) ids.without(place).store(other.lane);
  };
  if (first == 1) drop(behind[0]);
  for (unsigned k = first; k < last; ++k) {
    requeue(behind[k], bucket);
    Ring& other = a_.ring[behind[k]];
    Ids::load(other.lane).replace(v, u).store(other.lane);
  }
  if (last == n - 2) drop(behind[n - 2]);
  if (!piles_.empty()) follow_piles(v, u, ring);
  a_.ring[v].lane[flags_lane] = flags_base | gone;
  merge_bodies(v, u, t);
  live_ -= is_open ? 1 : 2;
}

}  // namespace lodestone::quadric
