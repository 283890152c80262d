// The collapse kernel on eight lanes at a time: every test of a vertex is one for all its neighbours, as in
// core/simplify/quadric/quadric_kernel.h. Vertices of more than sixteen neighbours take a slow path, one by one.
//
// The queue is a heap that is updated lazily: a collapse only marks the vertices around it, and a marked vertex is
// evaluated again when it comes up. Ties are broken by the number of the vertex.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/base/prefetch.h"
#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/rank_heap.h"
#include "core/progressive/collapse/star_quadrics.h"
#include "core/progressive/collapse/texture_ranks.h"

namespace lodestone::progressive {
inline namespace LODESTONE_LANES {

// A vertex whose rank has risen by no more than this goes at once instead of back into the queue.
inline constexpr float patience = 1.125f;

class CollapseRun {
 public:
  explicit CollapseRun(CollapseState& state)
      : s_(state),
        rings_(state.rings),
        metric_(state.metric),
        quadrics_(state.metric.plane_quadrics()),
        texture_(state.metric.texture_points()),
        texture_ranks_(state.rings, texture_) {}

  void start(std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (rings_.is_used(static_cast<Id>(v))) start(static_cast<Id>(v));
  }

  std::vector<CollapseRecord> run(const Region& region, RingArena& arena) {
    std::vector<CollapseRecord> records;
    fill_queue(region);
    float order = 0;
    std::size_t gone = 0;
    const float max_rank = std::min(region.max_rank, std::numeric_limits<float>::max());
    while (!queue_.empty() && gone < region.max_triangles) {
      const float expected = queue_.lowest();
      const Id v = queue_.pop();
      VertexState& at = s_.vertices[v];
      at.clear(VertexState::queued);
      Collapse c;
      if (at.has(VertexState::dirty) || !is_still_allowed(v, c)) {
        if (!evaluate(v, c) || at.rank > max_rank) continue;
        if (at.rank > std::max(patience * expected, queue_.lowest())) {
          queue_.push(at.rank, v);
          at.bits |= VertexState::queued;
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
    for (const Id v : region.vertices) s_.vertices[v].clear(VertexState::member | VertexState::queued);
    return records;
  }

 private:
  static constexpr float never = std::numeric_limits<float>::infinity();

  // The lanes of the ring that v may collapse into: borders collapse along borders.
  static unsigned lanes_of(const Ring& ring) { return static_cast<unsigned>(places_of(ring)); }
  static std::uint64_t places_of(const Ring& ring) {
    return ring.open != 0 ? std::uint64_t{1} | std::uint64_t{1} << (ring.size - 1) : all_of(ring);
  }
  static std::uint64_t all_of(const Ring& ring) { return ~std::uint64_t{0} >> (64 - ring.size); }

  void start(Id v) {
    VertexState& at = s_.vertices[v];
    const Ring& ring = rings_.ring(v);
    at.bits = VertexState::dirty;
    if (ring.size > CollapseMetric::max_neighbours) return;
    if (quadrics_ != nullptr && ring.size <= 8) {
      Float8 ranks[1];
      star_ranks<1>(quadrics_[v], load_star<1>(rings_.points(), ring, v), ranks);
      at.rank = lowest(select(lanes_of(ring), ranks[0], all8(never)));
    } else if (texture_ != nullptr && ring.size > 0) {
      at.rank = texture_ranks_.cheapest(v, places_of(ring), [](std::uint32_t) { return true; }).rank;
    } else if (ring.size > 0) {
      at.rank =
          metric_.cheapest(v, ring.size > 8 ? all_of(ring) : lanes_of(ring), [](std::uint32_t) { return true; }).rank;
    }
  }

  void fill_queue(const Region& region) {
    queue_.clear();
    for (const Id v : region.vertices) {
      VertexState& at = s_.vertices[v];
      at.bits |= VertexState::member;
      const bool maybe = at.rank == never && at.has(VertexState::dirty);  // could not collapse, but things changed
      if (!maybe && (at.rank == never || at.rank > region.max_rank)) continue;
      queue_.add(maybe ? 0 : at.rank, v);
      prefetch(&rings_.points()[v]);
      if (texture_ != nullptr) prefetch(&texture_[v]);
      if (quadrics_ != nullptr) prefetch(&quadrics_[v]), prefetch(&quadrics_[v].bz);
      at.bits |= VertexState::queued;
    }
    queue_.order_all();
  }

  // Finds the cheapest neighbour that v may collapse into; false if there is none.
  bool evaluate(Id v, Collapse& collapse) {
    VertexState& at = s_.vertices[v];
    at.clear(VertexState::dirty);
    const Ring& ring = rings_.ring(v);
    collapse.vertex = v;
    const bool found = ring.size == 0    ? false
                       : ring.size <= 8  ? evaluate<1>(v, ring, collapse)
                       : ring.size <= 16 ? evaluate<2>(v, ring, collapse)
                                         : evaluate_crowded(v, ring, collapse);
    if (!found) at.rank = never;
    at.target = static_cast<std::uint16_t>(collapse.at);
    return found;
  }

  template <int G>
  bool evaluate(Id v, const Ring& ring, Collapse& c) {
    const Star<G> star = load_star<G>(rings_.points(), ring, v);
    const auto allowed = [&](std::uint32_t at) {
      c.at = at;
      c.target = ring.ids[at];
      return joins<G>(rings_, ring, at) && !star_turns<G>(star, ring, at) && complete(v, c);
    };
    if (quadrics_ == nullptr)
      return take_cheapest(v, lanes_of(ring), c, [&](std::uint32_t at) { return allowed(at) && metric_.allows(c); });
    Float8 ranks[G];
    star_ranks<G>(quadrics_[v], star, ranks);
    for (unsigned left = lanes_of(ring); left != 0; left &= ~(1u << c.at)) {
      float best = never;
      for (int g = 0; g < G; ++g) best = std::min(best, lowest(select(left >> 8 * g, ranks[g], all8(never))));
      if (!(best < never)) return false;
      unsigned lanes = 0;
      for (int g = 0; g < G; ++g) lanes |= bits(ranks[g] == all8(best)) << 8 * g;
      if (!allowed(static_cast<std::uint32_t>(std::countr_zero(lanes & left)))) continue;
      s_.vertices[v].rank = best;
      return true;
    }
    return false;
  }

  // `allowed` fills in the collapse. The metric may have asked about others after the cheapest.
  template <class Allowed>
  bool take_cheapest(Id v, std::uint64_t places, Collapse& c, const Allowed& allowed) {
    const CollapseMetric::Cheapest best = texture_ != nullptr ? texture_ranks_.cheapest(v, places, allowed)
                                                              : metric_.cheapest(v, places, std::ref(allowed));
    if (!(best.rank < never)) return false;
    if (c.at != best.at) {
      c.at = best.at, c.target = rings_.ring(v).ids[best.at];
      (void)complete(v, c);
    }
    s_.vertices[v].rank = best.rank;
    return true;
  }

  // Fills in the rest of a collapse that the surface allows; false if the wedges do not.
  bool complete(Id v, Collapse& c) const {
    c.back = rings_.ring(c.target).find(v);
    c.wedge[0] = c.wedge[1] = v, c.wedge_target[0] = c.wedge_target[1] = c.target;
    return (!rings_.has_wedges() || is_off_seams(c) || rings_.allows_wedges(c)) && keeps_apart(c);
  }

  // False if a copy of the vertex has gone to the same target: one record after the other, they would look like wedges
  // of one vertex (activation.h). Copies have the same place and therefore the same region.
  [[nodiscard]] bool keeps_apart(const Collapse& c) const {
    if (rings_.cut_vertices() == 0) return true;
    const Id original = rings_.original_of(c.vertex);
    const auto went = [&](Id x) { return s_.parent[x] != no_id && rings_.vertex_of(s_.parent[x]) == c.target; };
    if (went(original)) return false;
    for (auto [copy, last] = rings_.copies_of(original); copy != last; ++copy)
      if (went(copy)) return false;
    return true;
  }

  // True if the vertex and those of the triangles that vanish are known to have one wedge each.
  [[nodiscard]] bool is_off_seams(const Collapse& c) const {
    const Ring& ring = rings_.ring(c.vertex);
    if (texture_ == nullptr || ring.open != 0) return false;
    const auto several = [&](Id x) { return texture_[x].several != 0; };
    return !several(c.vertex) && !several(c.target) && !several(ring.ids[ring.next(c.at)]) &&
           !several(ring.ids[ring.previous(c.at)]);
  }

  bool evaluate_crowded(Id v, const Ring& ring, Collapse& c) {
    if (ring.size > CollapseMetric::max_neighbours) return false;
    return take_cheapest(v, places_of(ring), c, [&](std::uint32_t at) {
      c.target = ring.ids[at];
      return rings_.allows(c) && !turns(c) && keeps_apart(c) && metric_.allows(c);
    });
  }

  // star_turns, one by one.
  [[nodiscard]] bool turns(const Collapse& c) const {
    const Ring& ring = rings_.ring(c.vertex);
    const Vec3f from = rings_.position(c.vertex), way = rings_.position(c.target) - from;
    for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
      const Id first = ring.ids[k], second = ring.ids[ring.next(k)];
      if (first == c.target || second == c.target) continue;
      const Vec3f a = rings_.position(first) - from, b = rings_.position(second) - from;
      const Vec3f before = cross(a, b), after = cross(a - way, b - way);
      const float along = dot(before, after), size = dot(before, before);
      if (size > 0 && !(along > 0 && along * along > min_cosine * min_cosine * size * dot(after, after))) return true;
    }
    return false;
  }

  // The collapse of v as it was last evaluated: its own ring is unchanged, those of its neighbours may have changed.
  [[nodiscard]] bool is_still_allowed(Id v, Collapse& c) const {
    const Ring& ring = rings_.ring(v);
    c = {.vertex = v, .target = ring.ids[s_.vertices[v].target], .at = s_.vertices[v].target};
    if (ring.size > 8) return rings_.allows(c) && keeps_apart(c);
    return joins<1>(rings_, ring, c.at) && complete(v, c);
  }

  void collapse(const Collapse& c, RingArena& arena, CollapseRecord& record) {
    const Ring& ring = rings_.ring(c.vertex);
    const std::uint32_t size = ring.size;
    record.vertex = c.vertex;
    record.error = metric_.collapse(c, s_.vertices[c.vertex].rank);
    record.triangles = static_cast<std::uint16_t>(rings_.apply(c, arena));
    record.ring = static_cast<std::uint16_t>(size);
    s_.parent[c.vertex] = c.target;
    if (rings_.has_wedges())
      for (const int side : {0, 1}) s_.parent[c.wedge[side]] = c.wedge_target[side];
    const float rank = s_.vertices[c.vertex].rank;
    for (std::uint32_t k = 0; k < size; ++k) {
      const Id x = ring.ids[k];
      VertexState& at = s_.vertices[x];
      at.bits |= VertexState::dirty;
      // One that could not collapse may be able to now.
      if (at.rank == never && (at.bits & (VertexState::member | VertexState::queued)) == VertexState::member) {
        at.bits |= VertexState::queued;
        queue_.push(rank, x);
      }
    }
  }

  CollapseState& s_;
  RingMesh& rings_;
  CollapseMetric& metric_;
  const CentredQuadric* quadrics_;  // null: the metric has other ranks
  const TexturePoint* texture_;     // likewise
  TextureRanks texture_ranks_;
  RankHeap queue_;
};

inline constexpr CollapseKernel collapse_functions{
    .chain = chain_eight,
    .star_quadrics = star_quadrics,
    .start = [](CollapseState& state, std::size_t begin, std::size_t end) { CollapseRun(state).start(begin, end); },
    .run = [](CollapseState& state, const Region& region,
              RingArena& arena) { return CollapseRun(state).run(region, arena); }};

}  // namespace LODESTONE_LANES
}  // namespace lodestone::progressive
