// The slow, obvious twin of closing handles: all loops of all shortest-path trees, shortest first, until one does not
// separate the surface; triangles are flooded to see that.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/spherical/surface.h"

namespace lodestone::spherical {

class GreedyTwin {
 public:
  explicit GreedyTwin(const Surface& surface) : positions_(surface.positions), triangles_(surface.triangles) {}

  // The lengths of the loops, in the order of the cuts.
  std::vector<double> close() {
    std::vector<double> lengths;
    while (kind_of(triangles_, positions_.size()).euler < 2) {
      const auto [length, loop] = shortest();
      lengths.push_back(length);
      cut(loop);
    }
    return lengths;
  }

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  using Loop = std::vector<std::uint32_t>;

  struct Tree {
    std::vector<double> distance;
    std::vector<std::uint32_t> parent;
    // The simple cycle that an edge closes; empty if the edge is in the tree.
    [[nodiscard]] Loop close(std::uint32_t u, std::uint32_t v) const {
      if (parent[u] == v || parent[v] == u) return {};
      Loop up, down;
      std::set<std::uint32_t> above;
      for (std::uint32_t at = u;; at = parent[at]) {
        above.insert(at);
        if (parent[at] == at) break;
      }
      std::uint32_t meeting = v;
      for (; !above.contains(meeting); meeting = parent[meeting]) down.push_back(meeting);
      for (std::uint32_t at = u; at != meeting; at = parent[at]) up.push_back(at);
      up.push_back(meeting);
      up.insert(up.end(), down.rbegin(), down.rend());
      return up;
    }
  };

  [[nodiscard]] std::map<std::uint32_t, std::vector<std::uint32_t>> neighbours() const {
    std::map<std::uint32_t, std::vector<std::uint32_t>> result;
    for (const auto& [v] : triangles_)
      for (int k = 0; k < 3; ++k)
        if (!centres_.contains(v[k]) && !centres_.contains(v[(k + 1) % 3])) result[v[k]].push_back(v[(k + 1) % 3]);
    return result;
  }

  [[nodiscard]] double distance(std::uint32_t a, std::uint32_t b) const {
    return length(positions_[a] - positions_[b]);
  }

  [[nodiscard]] Tree tree(std::uint32_t root, const std::map<std::uint32_t, std::vector<std::uint32_t>>& around) const {
    Tree t{std::vector<double>(positions_.size(), std::numeric_limits<double>::infinity()),
           std::vector<std::uint32_t>(positions_.size(), root)};
    std::priority_queue<std::pair<double, std::uint32_t>> queue;
    t.distance[root] = 0;
    queue.emplace(0, root);
    while (!queue.empty()) {
      const auto [negative, u] = queue.top();
      queue.pop();
      if (-negative > t.distance[u]) continue;
      for (const std::uint32_t v : around.at(u))
        if (t.distance[u] + distance(u, v) < t.distance[v]) {
          t.distance[v] = t.distance[u] + distance(u, v);
          t.parent[v] = u;
          queue.emplace(-t.distance[v], v);
        }
    }
    return t;
  }

  [[nodiscard]] std::pair<double, Loop> shortest() const {
    const auto around = neighbours();
    std::map<std::uint32_t, Tree> trees;
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t, std::uint32_t>> candidates;
    for (const auto& [root, _] : around) {
      const Tree& t = trees.emplace(root, tree(root, around)).first->second;
      for (const auto& [u, row] : around)
        for (const std::uint32_t v : row)
          if (u < v) candidates.emplace_back(t.distance[u] + distance(u, v) + t.distance[v], root, u, v);
    }
    std::sort(candidates.begin(), candidates.end());
    std::map<Edge, std::uint32_t> triangle_at;
    for (std::uint32_t side = 0; side < 3 * triangles_.size(); ++side)
      triangle_at[{triangles_[side / 3].v[side % 3], triangles_[side / 3].v[(side % 3 + 1) % 3]}] = side / 3;
    for (const auto& [length, root, u, v] : candidates) {
      const Loop loop = trees.at(root).close(u, v);
      if (loop.size() >= 3 && passes(loop, root) && !separates(loop, triangle_at)) return {length, loop};
    }
    return {};
  }

  static bool passes(const Loop& loop, std::uint32_t v) { return std::find(loop.begin(), loop.end(), v) != loop.end(); }

  static std::set<Edge> edges_of(const Loop& loop) {
    std::set<Edge> edges;
    for (std::size_t k = 0; k < loop.size(); ++k) edges.insert(std::minmax(loop[k], loop[(k + 1) % loop.size()]));
    return edges;
  }

  // Sides by edge; those on the loop are left out.
  [[nodiscard]] std::map<Edge, std::vector<std::uint32_t>> joints(const Loop& loop) const {
    const std::set<Edge> cut = edges_of(loop);
    std::map<Edge, std::vector<std::uint32_t>> sides;
    for (std::uint32_t side = 0; side < 3 * triangles_.size(); ++side) {
      const auto& v = triangles_[side / 3].v;
      const Edge edge = std::minmax(v[side % 3], v[(side % 3 + 1) % 3]);
      if (!cut.contains(edge)) sides[edge].push_back(side);
    }
    return sides;
  }

  // Floods both sides in turns until they meet or one of them ends.
  [[nodiscard]] bool separates(const Loop& loop, const std::map<Edge, std::uint32_t>& triangle_at) const {
    const std::set<Edge> cut = edges_of(loop);
    std::array<std::vector<std::uint32_t>, 2> reached{
        {{triangle_at.at({loop[0], loop[1]})}, {triangle_at.at({loop[1], loop[0]})}}};
    std::array<std::set<std::uint32_t>, 2> seen{{{reached[0][0]}, {reached[1][0]}}};
    for (std::size_t at = 0;; ++at)
      for (const std::size_t side : {0, 1}) {
        if (at == reached[side].size()) return true;
        const auto& v = triangles_[reached[side][at]].v;
        for (int k = 0; k < 3; ++k) {
          if (cut.contains(std::minmax(v[k], v[(k + 1) % 3]))) continue;
          const std::uint32_t next = triangle_at.at({v[(k + 1) % 3], v[k]});
          if (seen[1 - side].contains(next)) return false;
          if (seen[side].insert(next).second) reached[side].push_back(next);
        }
      }
  }

  void cut(const Loop& loop) {
    DisjointSets fans(3 * triangles_.size());  // of corners
    const auto after = [](std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; };
    for (const auto& [_, sides] : joints(loop)) {
      fans.unite(sides[0], after(sides[1]));
      fans.unite(sides[1], after(sides[0]));
    }
    // The first fan of a vertex keeps it; those of the second side get a copy.
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> names;
    std::vector<Triangle> renamed = triangles_;
    for (std::uint32_t corner = 0; corner < 3 * triangles_.size(); ++corner) {
      const std::uint32_t v = triangles_[corner / 3].v[corner % 3];
      auto& of_vertex = names[v];
      const auto [at, is_new] = of_vertex.try_emplace(fans.find(corner), v);
      if (is_new && of_vertex.size() > 1) {
        at->second = static_cast<std::uint32_t>(positions_.size());
        positions_.push_back(positions_[v]);
      }
      renamed[corner / 3].v[corner % 3] = at->second;
    }
    triangles_ = std::move(renamed);
    cap_borders();
  }

  // A fan around a centre, which no path passes, for each of the loops of sides without a neighbour.
  void cap_borders() {
    std::set<Edge> directed;
    for (const auto& [v] : triangles_)
      for (int k = 0; k < 3; ++k) directed.insert({v[k], v[(k + 1) % 3]});
    std::map<std::uint32_t, std::uint32_t> next;
    for (const auto& [a, b] : directed)
      if (!directed.contains({b, a})) next[b] = a;
    while (!next.empty()) {
      const auto centre = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(positions_[next.begin()->first]);
      centres_.insert(centre);
      for (auto at = next.begin(); at != next.end(); at = next.find(triangles_.back().v[1])) {
        triangles_.push_back({{at->first, at->second, centre}});
        next.erase(at);
      }
    }
  }

  std::vector<Vec3d> positions_;
  std::vector<Triangle> triangles_;
  std::set<std::uint32_t> centres_;
};

}  // namespace lodestone::spherical
