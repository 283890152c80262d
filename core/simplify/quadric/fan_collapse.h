// The queue, and the collapses of vertices whose star is one fan.
#pragma once

#include "core/simplify/quadric/nonmanifold_collapse.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// Vertices that are evaluated side by side. More overlap better but spoil one another's rings: of four 2 % have to be
// evaluated again.
inline constexpr unsigned batch_size = 4;

// True if this makes a new edge, or triangle, of locked vertices only: the block on the other side could make it too.
inline bool makes_locked_chord(const Block& b, const Ring& ring, unsigned n, unsigned lane) {
  // The neighbours that v and the target have in common; on the border there is one.
  const bool is_open = ring.has(open);
  const unsigned before = lane > 0 ? lane - 1 : is_open ? n : n - 1;
  const unsigned after = lane + 1 < n ? lane + 1 : is_open ? n : 0;
  unsigned count = 0;
  for (unsigned k = 0; k < n; ++k) {
    if (k == lane || !b.a.ring[ring.lane[k]].has(locked)) continue;
    ++count;
    if (k != before && k != after) return true;
  }
  return n == 3 && count == 2;
}

// The link condition: v and its target have no other neighbours in common than the triangles at their edge say.
[[nodiscard, gnu::always_inline]] inline bool is_joinable(const Block& b, Id v, unsigned n, unsigned lane) {
  const Ring& ring = b.a.ring[v];
  const Ring& target = b.a.ring[ring.lane[lane]];
  if (target.has(crowded) || target.has(sealed)) return false;
  if (ring.has(seamed) && !b.seams->allows(v, ring.lane[lane])) return false;
  const Id16 target_ids = Id16::load(target.lane);
  const unsigned m = target_ids.find(none);
  const bool is_open = ring.has(open);
  const unsigned joined = m + n - (is_open ? 3 : 4);
  if (joined > ring_capacity) return false;
  if (target_ids.count_common(m, Id16::load(ring.lane), n) != (is_open ? 1u : 2u)) return false;
  if (!is_open) {
    if (target.has(nonmanifold) ? n == 3 : !target.has(open) && joined < 3) return false;  // would double a triangle
  } else if (n == 2 && (target.has(nonmanifold) || m < 3)) {
    return false;  // an ear whose last edge carries nothing else
  }
  return !target.has(locked) || !makes_locked_chord(b, ring, n, lane);
}

// A collapse of v by t into the neighbour in `lane`. `after` are the neighbours that follow the target, in order. The
// first and the last of them are neighbours of the target already; on the border only one of them is.
struct FanCollapse {
  Id v;
  unsigned n, lane;
  const Id* after;
  Vec3f t;
};

[[gnu::always_inline]] inline void collapse(Block& b, const FanCollapse& c, unsigned bucket) {
  const Id v = c.v;
  const unsigned n = c.n;
  const Ring& ring = b.a.ring[v];
  const Id u = ring.lane[c.lane];
  const bool is_open = ring.has(open);
  if (b.seams != nullptr) b.seams->collapse(v, u, b.a);
  const unsigned first = is_open && c.lane != 0 ? 0 : 1, last = is_open && c.lane == 0 ? n - 1 : n - 2;

  b.requeue(u, bucket);
  Ring& target = b.a.ring[u];
  Id16::spliced(target, Id16::load(target.lane).find(v), c.after + first, last - first).store(target.lane);

  const auto drop = [&](Id x) {
    b.requeue(x, bucket);
    Ring& other = b.a.ring[x];
    const Id16 ids = Id16::load(other.lane);
    if (const unsigned place = ids.find(v); place < 16) ids.without(place).store(other.lane);
  };
  if (first == 1) drop(c.after[0]);
  for (unsigned k = first; k < last; ++k) {
    b.requeue(c.after[k], bucket);
    Ring& other = b.a.ring[c.after[k]];
    Id16::load(other.lane).replace(v, u).store(other.lane);
  }
  if (last == n - 2) drop(c.after[n - 2]);
  if (!b.stars.empty()) update_nonmanifold(b, v, u, ring);
  b.a.ring[v].lane[flags_lane] = flags_base | gone;
  merge_bodies(b, v, u, c.t);
  b.live -= is_open ? 1 : 2;
}

// Collapses the candidate into the cheapest target at the price of the bucket. If there is none, the candidate goes
// back, or leaves the queue.
template <int G>
[[gnu::always_inline]] inline void decide(Block& b, unsigned n, Candidate<G>& c, unsigned bucket) {
  Ring& ring = b.a.ring[c.v];
  if (c.lane < 32) {
    if (c.bucket > bucket + patience) return b.push(c.v, c.bucket);
    __builtin_prefetch(&b.a.body[ring.lane[c.lane]]);
    c.ring.store(c.around + turn_front);
    c.ring.store(c.around + turn_front + n);
    const Faces<G> faces = faces_of<G>(c.star, n);
    const unsigned real = (1u << (ring.has(open) ? n - 1 : n)) - 1;
    do {
      const unsigned lane = c.lane;
      if ((c.near >> lane & 1) == 0) c.allowed &= c.near = within_bound<G>(b, c.v, c.star);
      if ((c.allowed >> lane & 1) != 0) {
        const int g = G == 1 || lane < 8 ? 0 : G - 1;
        const unsigned k = lane - 8 * static_cast<unsigned>(g);
        const Vec3f t{pick(c.star.x[g], k), pick(c.star.y[g], k), pick(c.star.z[g], k)};
        // The triangles on both sides of the edge vanish.
        const unsigned vanish = 1u << lane | 1u << (lane == 0 ? n - 1 : lane - 1);
        if ((flipped<G>(faces, t) & real & ~vanish) == 0 && is_joinable(b, c.v, n, lane))
          return collapse(b, {c.v, n, lane, c.around + turn_front + (lane + 1 < n ? lane + 1 : 0), t}, bucket);
        c.allowed &= ~(1u << lane);
      }
      choose(c);
      if (c.lane >= 32) break;
      if (c.bucket > bucket + patience) return b.push(c.v, c.bucket);
    } while (true);
  }
  b.leave_queue(c.v);
}

[[gnu::noinline]] inline void visit_large_fan(Block& b, Id v, unsigned n, unsigned bucket) {
  Candidate<2> c;
  survey(b, v, n, c), rate(b, c), choose(c);
  decide(b, n, c, bucket);
}

// The next vertices of a bucket.
[[nodiscard]] inline unsigned take(Block& b, unsigned bucket, Id (&batch)[batch_size]) {
  unsigned count = 0;
  Id v = b.a.bucket[bucket];
  for (; v != none && count < batch_size; v = b.a.next_in_bucket[v]) {
    batch[count++] = v;
    __builtin_prefetch(&b.a.ring[v]);
    __builtin_prefetch(&b.a.body[v]);
    __builtin_prefetch(&b.a.point[v]);
  }
  b.a.bucket[bucket] = v;
  return count;
}

// A vertex is evaluated when it comes up, not when its surroundings change: costs mostly rise, and one that has risen
// by more than `patience` goes back. Several come up together and are evaluated side by side, step by step, since each
// step of one waits for the step before; a collapse among them may leave another to be evaluated again.
inline void collapse_to_target(Block& b) {
  // A nonmanifold vertex may take more than two triangles with it: a third of those that it has is assumed.
  const std::size_t target = triangles_to_keep(b.input, b.movable_fans + b.movable_corners / 6);
  Id next[batch_size];
  Candidate<1> batch[batch_size];
  for (unsigned bucket = 0; bucket < bucket_count; ++bucket) {
    for (unsigned count = take(b, bucket, next); count > 0;) {
      const unsigned now = count;
      // For a vertex of more than eight neighbours this is incomplete, and not used.
      for (unsigned i = 0; i < now; ++i) survey(b, next[i], std::min(b.degree(next[i]), 8u), batch[i]);
      for (unsigned i = 0; i < now; ++i) rate(b, batch[i]);
      for (unsigned i = 0; i < now; ++i) choose(batch[i]);
      count = take(b, bucket, next);  // already, so that memory has time
      for (unsigned i = 0; i < now; ++i) {
        if (b.live <= target) return;
        Candidate<1>& c = batch[i];
        const unsigned n = b.degree(c.v);
        if (b.a.ring[c.v].has(nonmanifold)) {
          visit_nonmanifold(b, c.v, bucket);
          continue;
        }
        if (n > 8) {
          visit_large_fan(b, c.v, n, bucket);
          continue;
        }
        if (!Id16::load(b.a.ring[c.v].lane).same(c.ring)) survey(b, c.v, n, c), rate(b, c), choose(c);
        decide(b, n, c, bucket);
      }
    }
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
