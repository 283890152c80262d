// An independent verifier of the simplifiers' contract: counts edges and fans in plain maps, shares no code with them.
//
// broken_contract is asserted for every simplifier. For topology-keeping ones also: every vertex of a manifold input
// manifold, the same Euler characteristic, components and border loops, no new non-manifold or misoriented edge, no new
// edge between two locked vertices.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/simplify/contract/checked_simplifier.h"

namespace lodestone::simplify_test {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// The properties of a mesh that must survive.
struct Topology {
  std::size_t vertices = 0, edges = 0;
  std::size_t triangles = 0;  // doubled ones once
  std::size_t components = 0, border_loops = 0;
  std::size_t crowded_edges = 0;      // used by more than two triangles
  std::size_t misoriented_edges = 0;  // used twice in the same direction
  std::size_t pinched_vertices = 0;   // not one fan
  std::set<Edge> edge_set;
  [[nodiscard]] long euler() const {
    return static_cast<long>(vertices) - static_cast<long>(edges) + static_cast<long>(triangles);
  }
  [[nodiscard]] bool manifold() const { return crowded_edges + misoriented_edges + pinched_vertices == 0; }
};

// Disjoint sets, for counting connected parts.
class Parts {
 public:
  std::uint32_t root(std::uint32_t v) {
    parent_.try_emplace(v, v);
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }
  [[nodiscard]] std::size_t count() const {
    std::size_t n = 0;
    for (const auto& [v, p] : parent_) n += v == p;
    return n;
  }

 private:
  std::map<std::uint32_t, std::uint32_t> parent_;
};

// True if the triangles around one vertex, given as directed edges of its link, form one open or closed fan.
inline bool one_fan(const std::vector<Edge>& link) {
  std::map<std::uint32_t, int> degree;
  Parts parts;
  for (const auto& [a, b] : link) {
    ++degree[a], ++degree[b];
    parts.join(a, b);
  }
  int ends = 0;
  for (const auto& [v, d] : degree) {
    if (d > 2) return false;
    ends += d == 1;
  }
  return parts.count() == 1 && (ends == 0 || ends == 2);
}

inline Topology topology_of(const std::vector<Triangle>& triangles) {
  Topology t;
  std::set<std::array<std::uint32_t, 3>> distinct;
  std::map<Edge, std::array<int, 2>> uses;  // of an ascending edge: upwards, downwards
  std::map<std::uint32_t, std::vector<Edge>> links;
  Parts parts;
  for (const auto& [v] : triangles) {
    auto corners = v;
    std::ranges::sort(corners);
    distinct.insert({corners[0], corners[1], corners[2]});
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      ++uses[std::minmax(a, b)][a > b];
      links[a].emplace_back(b, v[(k + 2) % 3]);
      parts.join(a, b);
    }
  }
  t.triangles = distinct.size();
  Parts borders;
  for (const auto& [edge, n] : uses) {
    t.edge_set.insert(edge);
    t.crowded_edges += n[0] + n[1] > 2;
    t.misoriented_edges += n[0] > 1 || n[1] > 1;
    if (n[0] + n[1] == 1) borders.join(edge.first, edge.second);
  }
  t.vertices = links.size();
  t.edges = uses.size();
  t.components = parts.count();
  t.border_loops = borders.count();
  for (const auto& [v, link] : links) t.pinched_vertices += !one_fan(link);
  return t;
}

inline std::vector<Triangle> image(const SimplifyInput& input, const SimplifyResult& result) {
  std::vector<Triangle> left;
  for (const auto& [v] : input.triangles) {
    const Triangle t{{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}};
    if (!is_degenerate(t)) left.push_back(t);
  }
  return left;
}

// Checks what simplifiers that keep the topology promise beyond broken_contract: empty, or the first broken promise.
inline std::string broken_topology(const SimplifyInput& input, const SimplifyResult& result) {
  const Topology before = topology_of({input.triangles.begin(), input.triangles.end()});
  const Topology after = topology_of(image(input, result));
  const auto changed = [](const char* what, auto was, auto is) {
    return std::string(what) + " " + std::to_string(was) + " -> " + std::to_string(is);
  };
  if (after.crowded_edges > before.crowded_edges)
    return changed("non-manifold edges", before.crowded_edges, after.crowded_edges);
  if (after.misoriented_edges > before.misoriented_edges)
    return changed("misoriented edges", before.misoriented_edges, after.misoriented_edges);
  if (after.pinched_vertices > before.pinched_vertices)
    return changed("non-manifold vertices", before.pinched_vertices, after.pinched_vertices);
  if (after.euler() != before.euler()) return changed("Euler characteristic", before.euler(), after.euler());
  if (after.components != before.components) return changed("components", before.components, after.components);
  if (before.manifold() && after.border_loops != before.border_loops)
    return changed("border loops", before.border_loops, after.border_loops);
  for (const auto& [a, b] : after.edge_set)
    if (input.locked[a] && input.locked[b] && !before.edge_set.contains({a, b}))
      return "new edge between locked vertices " + std::to_string(a) + " and " + std::to_string(b);
  return {};
}

}  // namespace lodestone::simplify_test
