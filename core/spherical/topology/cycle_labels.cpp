#include "core/spherical/topology/cycle_labels.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <utility>

#include "core/base/disjoint_sets.h"

namespace lodestone::spherical {
namespace {

struct Edge {
  Id vertex = 0;
  std::uint32_t link = 0;  // its place at the vertex
  Id left = 0, right = 0;  // faces
  std::uint64_t label = 0;
};

// The edges outside the tree of the last search; those of the longest loops through its seed come first.
std::vector<Edge> edges_by_length(const SurfaceGraph& graph, const BallSearch& search) {
  std::vector<Edge> edges;
  std::vector<std::uint64_t> keys;
  for (Id v = 0; v < graph.vertex_count(); ++v) {
    const std::span row = graph.links(v);
    for (std::uint32_t k = 0; k < row.size(); ++k) {
      const Id to = row[k].to;
      if (to < v || search.parent(to) == v || search.parent(v) == to) continue;
      const float length = search.distance(v) + search.distance(to) + row[k].length;
      keys.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(length)} << 32 | edges.size());
      edges.push_back({v, k, graph.face(v, k), graph.face(v, k == 0 ? row.size() - 1 : k - 1)});
    }
  }
  std::sort(keys.begin(), keys.end(), std::greater<>());
  std::vector<Edge> sorted;
  sorted.reserve(edges.size());
  for (const std::uint64_t key : keys) sorted.push_back(edges[static_cast<std::uint32_t>(key)]);
  return sorted;
}

// Splits the edges into a spanning tree of the faces, which come first, and the remaining 2 * genus.
std::size_t span_faces(std::vector<Edge>& edges, std::size_t face_count) {
  DisjointSets faces(face_count);
  const auto rest =
      std::stable_partition(edges.begin(), edges.end(), [&](const Edge& e) { return faces.unite(e.left, e.right); });
  return static_cast<std::size_t>(rest - edges.begin());
}

// Labels the edges of the tree of faces from its leaves on: those of each face cancel each other out.
void label_tree(std::span<Edge> tree, std::span<const Edge> generators, std::size_t face_count) {
  struct Face {
    std::uint64_t label = 0;               // of the edges that have one
    std::uint32_t missing = 0, names = 0;  // edges that have none: how many, and the exclusive or of their numbers
  };
  std::vector<Face> faces(face_count);
  for (const Edge& e : generators)
    for (const Id f : {e.left, e.right}) faces[f].label ^= e.label;
  for (std::uint32_t k = 0; k < tree.size(); ++k)
    for (const Id f : {tree[k].left, tree[k].right}) ++faces[f].missing, faces[f].names ^= k;
  for (Id first = 0; first < face_count; ++first)
    for (Id f = first; faces[f].missing == 1;) {
      Edge& e = tree[faces[f].names];
      e.label = faces[f].label;
      const Id other = e.left == f ? e.right : e.left;
      faces[f] = {};
      faces[other].label ^= e.label;
      --faces[other].missing;
      faces[other].names ^= static_cast<std::uint32_t>(&e - tree.data());
      f = other;
    }
}

void set_label(SurfaceGraph& graph, const Edge& e) {
  Link& link = graph.links(e.vertex)[e.link];
  link.label = e.label;
  graph.links(link.to)[graph.find(link.to, e.vertex)].label = e.label;
}

}  // namespace

Generators label_cycles(SurfaceGraph& graph, BallSearch& search, std::mt19937_64& random) {
  search.grow(graph, 0);
  std::vector<Edge> edges = edges_by_length(graph, search);
  for (Id v = 0; v < graph.vertex_count(); ++v)
    for (Link& link : graph.links(v)) link.label = 0;
  const std::size_t in_tree = span_faces(edges, graph.face_count());
  const std::span<Edge> tree(edges.data(), in_tree), generators(edges.data() + in_tree, edges.size() - in_tree);
  for (std::size_t k = 0; k < generators.size(); ++k)
    generators[k].label = generators.size() <= 64 ? std::uint64_t{1} << k : random();
  label_tree(tree, generators, graph.face_count());
  Generators loops;
  for (const Edge& e : edges) set_label(graph, e);
  for (const Edge& e : generators) loops.push_back(search.close(e.vertex, graph.links(e.vertex)[e.link].to));
  return loops;
}

}  // namespace lodestone::spherical
