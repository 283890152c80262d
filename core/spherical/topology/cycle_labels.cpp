#include "core/spherical/topology/cycle_labels.h"

#include <span>
#include <utility>

#include "core/base/disjoint_sets.h"

namespace lodestone::spherical {
namespace {

struct Edge {
  Id vertex = 0;
  std::uint32_t link = 0;  // its place at the vertex
  Id left = 0, right = 0;  // faces
};

// The edges outside a shortest-path tree.
struct OtherEdges {
  std::vector<Edge> tree;        // a spanning tree of the faces
  std::vector<Edge> generators;  // the remaining 2 * genus
};

// The spanning tree gets the edges far from the seed of the last search first, so that those that remain close short
// loops. Edges come in the order of their farther ends: about that of their loops, without sorting.
OtherEdges split_edges(const SurfaceGraph& graph, const BallSearch& search) {
  OtherEdges edges;
  edges.tree.reserve(graph.face_count());
  DisjointSets faces(graph.face_count());
  const std::span order = search.reached();
  for (std::size_t at = order.size(); at-- > 0;) {
    const Id v = order[at];
    const std::span row = graph.links(v);
    for (std::uint32_t k = 0; k < row.size(); ++k) {
      const Id to = row[k].to;
      const bool is_farther = std::pair(search.distance(v), v) > std::pair(search.distance(to), to);
      if (!is_farther || search.parent(v) == to) continue;
      const Edge edge{v, k, graph.face(v, k), graph.face(v, k == 0 ? row.size() - 1 : k - 1)};
      (faces.unite(edge.left, edge.right) ? edges.tree : edges.generators).push_back(edge);
    }
  }
  return edges;
}

void set_label(SurfaceGraph& graph, const Edge& e, std::uint64_t label) {
  Link& link = graph.links(e.vertex)[e.link];
  graph.set_label(link, label);
  graph.set_label(graph.links(link.to)[graph.find(link.to, e.vertex)], label);
}

// Labels the edges of the tree of faces from its leaves on: those of each face cancel each other out.
void label_tree(SurfaceGraph& graph, std::span<const Edge> tree, std::span<const Edge> generators) {
  struct Face {
    std::uint64_t label = 0;               // of the edges that have one
    std::uint32_t missing = 0, names = 0;  // edges that have none: how many, and the exclusive or of their numbers
  };
  std::vector<Face> faces(graph.face_count());
  for (const Edge& e : generators)
    for (const Id f : {e.left, e.right}) faces[f].label ^= graph.label(graph.links(e.vertex)[e.link]);
  for (std::uint32_t k = 0; k < tree.size(); ++k)
    for (const Id f : {tree[k].left, tree[k].right}) ++faces[f].missing, faces[f].names ^= k;
  for (Id first = 0; first < faces.size(); ++first)
    for (Id f = first; faces[f].missing == 1;) {
      const std::uint32_t name = faces[f].names;
      const Edge& e = tree[name];
      const std::uint64_t label = faces[f].label;
      if (label != 0) set_label(graph, e, label);
      faces[f].missing = 0;
      f = e.left == f ? e.right : e.left;
      faces[f].label ^= label;
      --faces[f].missing;
      faces[f].names ^= name;
    }
}

}  // namespace

Generators label_cycles(SurfaceGraph& graph, BallSearch& search, std::mt19937_64& random) {
  search.grow(graph, 0);
  const OtherEdges edges = split_edges(graph, search);
  for (Id v = 0; v < graph.vertex_count(); ++v)
    for (Link& link : graph.links(v)) link.is_labelled = 0;
  const std::size_t count = edges.generators.size();
  for (std::size_t k = 0; k < count; ++k)
    set_label(graph, edges.generators[k], count <= 64 ? std::uint64_t{1} << k : random());
  label_tree(graph, edges.tree, edges.generators);
  Generators loops;
  for (const Edge& e : edges.generators) loops.push_back(search.close(e.vertex, graph.links(e.vertex)[e.link].to));
  return loops;
}

}  // namespace lodestone::spherical
