#include "core/spherical/topology/ball_search.h"

#include <algorithm>

namespace lodestone::spherical {

void BallSearch::begin(const SurfaceGraph& graph, Id seed) {
  if (nodes_.size() < graph.vertex_count()) {
    nodes_.resize(graph.vertex_count());
    parents_.resize(graph.vertex_count());
  }
  ++search_;
  reached_.clear();
  queue_.begin(graph.mean_length(), graph.greatest_length());
  nodes_[seed] = {0, 0, search_};
  parents_[seed] = no_id;
  queue_.push(seed, 0);
}

// The nearest vertex whose distance is not final yet; it is now.
bool BallSearch::next(const SurfaceGraph& graph, Id& v) {
  float distance = 0;
  const auto fetch = [&](std::span<const std::uint64_t> keys) {
    for (const std::uint64_t key : keys) graph.prefetch_row(static_cast<Id>(key));
    for (const std::uint64_t key : keys) graph.prefetch_links(static_cast<Id>(key));
  };
  while (queue_.pop(v, distance, fetch)) {
    if (distance > nodes_[v].distance) continue;  // it came nearer since
    reached_.push_back(v);
    return true;
  }
  return false;
}

void BallSearch::grow(const SurfaceGraph& graph, Id seed) {
  begin(graph, seed);
  for (Id u = 0; next(graph, u);)
    for (const Link& link : graph.links(u)) {
      Node& x = nodes_[link.to];
      const float distance = nodes_[u].distance + link.length;
      if (x.search == search_ && distance >= x.distance) continue;
      x = {0, distance, search_};
      parents_[link.to] = u;
      queue_.push(link.to, distance);
    }
}

Loop BallSearch::find_loop(const SurfaceGraph& graph, const XorBasis& closed, Id seed, double limit) {
  begin(graph, seed);
  Loop best{limit, 0, {}};
  Id end = no_id, other_end = no_id;
  auto radius = static_cast<float>(0.5 * limit);
  for (Id u = 0; next(graph, u);) {
    const Node at = nodes_[u];
    if (at.distance > radius) {
      reached_.pop_back();
      break;
    }
    for (const Link& link : graph.links(u)) {
      Node& x = nodes_[link.to];
      const float distance = at.distance + link.length;
      const bool is_seen = x.search == search_;
      if (is_seen && (x.distance < at.distance || (x.distance == at.distance && link.to < u))) {  // final
        const std::uint64_t label = at.label ^ graph.label(link) ^ x.label;
        const double length = double{distance} + x.distance;
        if (label == 0 || length >= best.length || closed.reduce(label) == 0) continue;
        best.length = length, best.label = label;
        end = u, other_end = link.to;
        radius = static_cast<float>(0.5 * length);
      } else if (distance <= radius && (!is_seen || distance < x.distance)) {
        x = {at.label ^ graph.label(link), distance, search_};
        parents_[link.to] = u;
        queue_.push(link.to, distance);
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
  for (Id at = u; at != no_id; at = parents_[at]) from_u.push_back(at);
  for (Id at = v; at != no_id; at = parents_[at]) from_v.push_back(at);
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
