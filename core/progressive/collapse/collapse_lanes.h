// The collapse kernel on eight lanes at a time: every test of a vertex is one for all its neighbours, as in
// core/simplify/quadric/quadric_kernel.h. Vertices of more than sixteen neighbours go the long way, one by one.
//
// The queue is a heap that is looked after lazily: a collapse only marks the vertices around it, and a marked vertex is
// looked at again when it comes up. Ties are broken by the number of the vertex. The template parameter is the kind of
// lanes.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/prefetch.h"
#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/rank_heap.h"
#include "core/progressive/collapse/star_lanes.h"

namespace lodestone::progressive {

// A vertex whose rank has risen by no more than this goes at once instead of back into the queue.
inline constexpr float patience = 1.125f;

template <class L>
class CollapseRun {
 public:
  explicit CollapseRun(CollapseState& state)
      : s_(state), rings_(state.rings), metric_(state.metric), quadrics_(state.metric.plane_quadrics()) {}

  void start(std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (rings_.is_used(static_cast<Id>(v))) start(static_cast<Id>(v));
  }
  std::vector<CollapseRecord> run(const Region& region, RingArena& arena);

 private:
  using Float = typename L::Float;
  static constexpr float never = std::numeric_limits<float>::infinity();

  void start(Id v);
  bool look(Id v, Collapse& collapse);
  template <int G>
  bool look(Id v, const Ring& ring, Collapse& collapse);
  bool look_crowded(Id v, const Ring& ring, Collapse& collapse);
  template <int G>
  void rank(Id v, const Ring& ring, const Star<L, G>& star, Float (&ranks)[G]) const;
  [[nodiscard]] bool is_still_allowed(Id v, Collapse& collapse) const;
  [[nodiscard]] bool turns(const Collapse& collapse) const;
  template <int G>
  [[nodiscard]] static unsigned lanes_of(const Ring& ring);
  void collapse(const Collapse& collapse, RingArena& arena, CollapseRecord& record);
  void requeue_around(const Ring& ring, float rank);

  CollapseState& s_;
  RingMesh& rings_;
  CollapseMetric& metric_;
  const PlaneQuadric* quadrics_;  // null: the metric has other ranks
  RankHeap queue_;
};

// The lanes of the ring that v may collapse into: borders collapse along borders.
template <class L>
template <int G>
unsigned CollapseRun<L>::lanes_of(const Ring& ring) {
  return ring.open != 0 ? 1u | 1u << (ring.size - 1) : (1u << ring.size) - 1;
}

template <class L>
template <int G>
inline void CollapseRun<L>::rank(Id v, const Ring& ring, const Star<L, G>& star, Float (&ranks)[G]) const {
  if (quadrics_ != nullptr) return star_ranks<L, G>(quadrics_[v], star, ranks);
  alignas(32) float values[8 * G];
  for (float& value : values) value = never;
  metric_.rank(v, {values, ring.size});
  for (int g = 0; g < G; ++g) ranks[g] = Float::load(values + 8 * g);
}

template <class L>
void CollapseRun<L>::start(Id v) {
  Standing& at = s_.standing[v];
  const Ring& ring = rings_.ring(v);
  at.bits = Standing::dirty;
  if (ring.size > CollapseMetric::most_neighbours) return;
  if (ring.size <= 8) {
    Float ranks[1];
    rank<1>(v, ring, load_star<L, 1>(rings_.points(), ring, v), ranks);
    at.rank = lowest(select(lanes_of<1>(ring), ranks[0], Float::all(never)));
  } else {
    float ranks[CollapseMetric::most_neighbours];
    metric_.rank(v, {ranks, ring.size});
    at.rank = *std::min_element(ranks, ranks + ring.size);
  }
}

// Finds the cheapest neighbour that v may collapse into; false when there is none.
template <class L>
bool CollapseRun<L>::look(Id v, Collapse& collapse) {
  Standing& at = s_.standing[v];
  at.bits = static_cast<std::uint16_t>(at.bits & ~Standing::dirty);
  const Ring& ring = rings_.ring(v);
  collapse.vertex = v;
  const bool found = ring.size <= 8    ? look<1>(v, ring, collapse)
                     : ring.size <= 16 ? look<2>(v, ring, collapse)
                                       : look_crowded(v, ring, collapse);
  if (!found) at.rank = never;
  at.target = static_cast<std::uint16_t>(collapse.at);
  return found;
}

template <class L>
template <int G>
inline bool CollapseRun<L>::look(Id v, const Ring& ring, Collapse& c) {
  const Star<L, G> star = load_star<L, G>(rings_.points(), ring, v);
  Float ranks[G];
  rank<G>(v, ring, star, ranks);
  for (unsigned allowed = lanes_of<G>(ring); allowed != 0; allowed &= ~(1u << c.at)) {
    float best = never;
    for (int g = 0; g < G; ++g) best = std::min(best, lowest(select(allowed >> 8 * g, ranks[g], Float::all(never))));
    if (!(best < never)) return false;
    unsigned lanes = 0;
    for (int g = 0; g < G; ++g) lanes |= equal(ranks[g], best) << 8 * g;
    c.at = static_cast<std::uint32_t>(std::countr_zero(lanes & allowed));
    c.target = ring.ids[c.at];
    if (!joins<L, G>(rings_, ring, c.at) || star_turns<L, G>(star, ring, c.at)) continue;
    c.back = rings_.ring(c.target).find(v);
    c.wedge[0] = c.wedge[1] = v, c.wedge_target[0] = c.wedge_target[1] = c.target;
    if (rings_.has_wedges() && !rings_.lets_wedges(c)) continue;
    if (quadrics_ == nullptr && !metric_.allows(c)) continue;
    s_.standing[v].rank = best;
    return true;
  }
  return false;
}

template <class L>
bool CollapseRun<L>::look_crowded(Id v, const Ring& ring, Collapse& c) {
  if (ring.size > CollapseMetric::most_neighbours) return false;
  float ranks[CollapseMetric::most_neighbours];
  metric_.rank(v, {ranks, ring.size});
  while (true) {
    const auto best = static_cast<std::uint32_t>(std::min_element(ranks, ranks + ring.size) - ranks);
    if (!(ranks[best] < never)) return false;
    c.target = ring.ids[best];
    if (rings_.allows(c) && !turns(c) && metric_.allows(c)) {
      s_.standing[v].rank = ranks[best];
      return true;
    }
    ranks[best] = never;
  }
}

// Whether a triangle around v that stays would turn by 60 degrees or more, or lose its area: star_turns, one by one.
template <class L>
bool CollapseRun<L>::turns(const Collapse& c) const {
  const Ring& ring = rings_.ring(c.vertex);
  const Vec3f from = rings_.position(c.vertex), way = rings_.position(c.target) - from;
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    const Id first = ring.ids[k], second = ring.ids[ring.next(k)];
    if (first == c.target || second == c.target) continue;
    const Vec3f a = rings_.position(first) - from, b = rings_.position(second) - from;
    const Vec3f before = cross(a, b), after = cross(a - way, b - way);
    const float along = dot(before, after), size = dot(before, before);
    if (size > 0 && !(along > 0 && along * along > least_cosine * least_cosine * size * dot(after, after))) return true;
  }
  return false;
}

// The collapse of v as it was last looked at: its ring is what it was, those of its neighbours may not be.
template <class L>
bool CollapseRun<L>::is_still_allowed(Id v, Collapse& c) const {
  const Ring& ring = rings_.ring(v);
  c = {.vertex = v, .target = ring.ids[s_.standing[v].target], .at = s_.standing[v].target};
  if (ring.size > 8) return rings_.allows(c);
  if (!joins<L, 1>(rings_, ring, c.at)) return false;
  c.back = rings_.ring(c.target).find(v);
  c.wedge[0] = c.wedge[1] = v, c.wedge_target[0] = c.wedge_target[1] = c.target;
  return !rings_.has_wedges() || rings_.lets_wedges(c);
}

template <class L>
std::vector<CollapseRecord> CollapseRun<L>::run(const Region& region, RingArena& arena) {
  std::vector<CollapseRecord> records;
  queue_.clear();
  for (const Id v : region.vertices) {
    Standing& at = s_.standing[v];
    at.bits |= Standing::member;
    const bool maybe = at.rank == never && (at.bits & Standing::dirty) != 0;  // could not collapse, but things changed
    if (at.rank > region.most_rank && !maybe) continue;
    queue_.add(maybe ? 0 : at.rank, v);
    prefetch(&rings_.points()[v]);
    if (quadrics_ != nullptr) prefetch(&quadrics_[v]), prefetch(&quadrics_[v].bz);
    at.bits |= Standing::queued;
  }
  queue_.order_all();
  float order = 0;
  std::size_t gone = 0;
  const float most_rank = std::min(region.most_rank, std::numeric_limits<float>::max());
  while (!queue_.empty() && gone < region.most_triangles) {
    const float expected = queue_.lowest();
    const Id v = queue_.pop();
    Standing& at = s_.standing[v];
    at.bits = static_cast<std::uint16_t>(at.bits & ~Standing::queued);
    Collapse c;
    if ((at.bits & Standing::dirty) != 0 || !is_still_allowed(v, c)) {
      if (!look(v, c) || at.rank > most_rank) continue;
      if (at.rank > std::max(patience * expected, queue_.lowest())) {
        queue_.push(at.rank, v);
        at.bits |= Standing::queued;
        continue;
      }
    }
    CollapseRecord record;
    collapse(c, arena, record);
    order = std::max(order, at.rank);
    record.order = order;
    gone += record.triangles;
    records.push_back(record);
  }
  for (const Id v : region.vertices)
    s_.standing[v].bits = static_cast<std::uint16_t>(s_.standing[v].bits & ~(Standing::member | Standing::queued));
  return records;
}

template <class L>
void CollapseRun<L>::collapse(const Collapse& c, RingArena& arena, CollapseRecord& record) {
  const Ring& ring = rings_.ring(c.vertex);
  const std::uint32_t size = ring.size;
  record.vertex = c.vertex;
  record.error = metric_.collapse(c);
  record.triangles = static_cast<std::uint32_t>(rings_.apply(c, arena));
  s_.parent[c.vertex] = c.target;
  if (rings_.has_wedges())
    for (const int side : {0, 1}) s_.parent[c.wedge[side]] = c.wedge_target[side];
  const float rank = s_.standing[c.vertex].rank;
  for (std::uint32_t k = 0; k < size; ++k) {
    const Id x = ring.ids[k];
    Standing& at = s_.standing[x];
    at.bits |= Standing::dirty;
    // One that could not collapse may be able to now.
    if (at.rank == never && (at.bits & (Standing::member | Standing::queued)) == Standing::member) {
      at.bits |= Standing::queued;
      queue_.push(rank, x);
    }
  }
}

}  // namespace lodestone::progressive
