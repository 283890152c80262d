#include "core/spherical/topology/ball_search.h"

#include <algorithm>
#include <bit>
#include <functional>

namespace lodestone::spherical {

void BallSearch::begin(const SurfaceGraph& graph, Id seed) {
  if (nodes_.size() < graph.vertex_count()) nodes_.resize(graph.vertex_count());
  ++search_;
  heap_.clear();
  reached_.clear();
  nodes_[seed] = {0, 0, no_id, search_, 0};
  push(seed, 0);
}

// Bits of floats that are not negative are in the order of the floats; of equal ones the vertex decides.
void BallSearch::push(Id v, float distance) {
  heap_.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32 | v);
  std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
}

// The nearest vertex that is not settled yet, which it is then.
bool BallSearch::pop(Id& v) {
  while (!heap_.empty()) {
    v = static_cast<Id>(heap_.front());
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    heap_.pop_back();
    if (nodes_[v].settled == search_) continue;
    nodes_[v].settled = search_;
    reached_.push_back(v);
    return true;
  }
  return false;
}

void BallSearch::grow(const SurfaceGraph& graph, Id seed) {
  begin(graph, seed);
  for (Id u = 0; pop(u);)
    for (const Link& link : graph.links(u)) {
      Node& x = nodes_[link.to];
      const float distance = nodes_[u].distance + link.length;
      if (x.seen == search_ && distance >= x.distance) continue;
      x = {0, distance, u, search_, 0};
      push(link.to, distance);
    }
}

Loop BallSearch::find_loop(const SurfaceGraph& graph, const XorBasis& closed, Id seed, double limit) {
  begin(graph, seed);
  Loop best{limit, 0, {}};
  Id end = no_id, other_end = no_id;
  auto radius = static_cast<float>(0.5 * limit);
  for (Id u = 0; pop(u);) {
    const Node at = nodes_[u];
    if (at.distance > radius) {
      nodes_[u].settled = 0;
      reached_.pop_back();
      break;
    }
    for (const Link& link : graph.links(u)) {
      Node& x = nodes_[link.to];
      const float distance = at.distance + link.length;
      if (x.settled == search_) {
        const std::uint64_t label = at.label ^ link.label ^ x.label;
        const double length = double{distance} + x.distance;
        if (label == 0 || length >= best.length || closed.reduce(label) == 0) continue;
        best.length = length, best.label = label;
        end = u, other_end = link.to;
        radius = static_cast<float>(0.5 * length);
      } else if (distance <= radius && (x.seen != search_ || distance < x.distance)) {
        x = {at.label ^ link.label, distance, u, search_, 0};
        push(link.to, distance);
      }
    }
  }
  if (end == no_id) return {};
  best.vertices = close(end, other_end);
  best.length -= 2.0 * nodes_[best.vertices.front()].distance;
  return best;
}

std::vector<Id> BallSearch::close(Id u, Id v) const {
  std::vector<Id> from_u, from_v;
  for (Id at = u; at != no_id; at = nodes_[at].parent) from_u.push_back(at);
  for (Id at = v; at != no_id; at = nodes_[at].parent) from_v.push_back(at);
  Id meeting = no_id;
  while (!from_u.empty() && !from_v.empty() && from_u.back() == from_v.back()) {
    meeting = from_u.back();
    from_u.pop_back();
    from_v.pop_back();
  }
  std::vector<Id> loop(1, meeting);
  loop.insert(loop.end(), from_v.rbegin(), from_v.rend());
  loop.insert(loop.end(), from_u.begin(), from_u.end());
  return loop;
}

}  // namespace lodestone::spherical
