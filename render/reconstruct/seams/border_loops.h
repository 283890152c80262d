// The border edges of a surface that is being sewn together, as loops around its holes.
//
// A border edge a -> b belongs to the triangle inside of it; b -> a is free. Fans that meet in a vertex are apart here,
// as they will be in the end: round a hole one goes along one fan. Adding a triangle at an edge replaces it by two, and
// glues these to border edges that run against them.
//
// Labelled, it also knows which edges are of one loop and which loops are of one piece of surface, and with that what a
// triangle does to the surface as a whole: pieces that are disks with holes, glued along their borders, get a handle
// exactly when two loops of one piece become one. (Gluing two edges takes one from the Euler characteristic; so does a
// piece less, or a loop more, in 2 pieces - 2 handles - loops. A loop less has to be made up for by a handle.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/base/id.h"

namespace lodestone {

using BorderEdgeId = Id<struct BorderEdge>;  // index of an edge of BorderLoops

class BorderLoops {
 public:
  static constexpr BorderEdgeId none{0xFFFF'FFFFu};
  static constexpr VertexId no_vertex{0xFFFF'FFFFu};
  static constexpr std::uint32_t no_loop = 0xFFFF'FFFFu;

  struct Edge {
    VertexId from = no_vertex, to = no_vertex;  // no_vertex: the edge was removed
    BorderEdgeId next = none, previous = none;  // around the hole; none: outside of this part
    BorderEdgeId sibling = none;                // another edge that leaves `from`
    std::uint32_t loop = no_loop;               // if labelled
    bool tried = false;                         // marks edges for the search for triangles
  };

  BorderLoops() = default;
  explicit BorderLoops(std::size_t vertices) : first_(vertices, none) {}

  VertexId add_vertex();
  // No triangle may run along to -> from.
  BorderEdgeId add_edge(VertexId from, VertexId to);
  void link(BorderEdgeId edge, BorderEdgeId next);
  // Takes the piece of surface of each edge, a number below `pieces`. Every edge must be linked.
  void label(std::span<const std::uint32_t> piece_of_edge, std::size_t pieces);

  [[nodiscard]] std::size_t edge_count() const { return edges_.size(); }  // also removed ones
  [[nodiscard]] const Edge& edge(BorderEdgeId e) const { return edges_[e]; }
  [[nodiscard]] bool alive(BorderEdgeId e) const { return edges_[e].from != no_vertex; }
  [[nodiscard]] BorderEdgeId first(VertexId v) const { return first_[v]; }  // edge that leaves v
  [[nodiscard]] BorderEdgeId find(VertexId from, VertexId to) const;
  // Vertices at which several fans may meet, ascending: several border edges leave them, or some did when a fan closed.
  [[nodiscard]] std::vector<VertexId> pinched() const;
  void set_tried(BorderEdgeId e, bool tried) { edges_[e].tried = tried; }

  // Triangle to -> from -> apex at an edge; neither from -> apex nor apex -> to may be taken by a triangle. The new
  // border edges from -> apex and apex -> to; none where they were glued.
  struct Sides {
    BorderEdgeId left = none, right = none;
  };
  Sides add_triangle(BorderEdgeId edge, VertexId apex);

  // The fan between the edge that arrives before `edge` and `edge` itself gets a vertex of its own.
  void move_start(BorderEdgeId edge, VertexId vertex);

  // The edges that leave the vertex are removed, and with them the surface there.
  void forget(VertexId vertex);

  // Labelled: whether add_triangle() would make a handle, or would touch another loop of the same piece, to which the
  // next triangle would be glued.
  [[nodiscard]] bool makes_handle(BorderEdgeId edge, VertexId apex) const;
  [[nodiscard]] std::size_t handles() const { return handles_; }  // made so far
  [[nodiscard]] std::uint32_t piece(BorderEdgeId edge) const { return pieces_.find(loops_[edges_[edge].loop].piece); }
  // The smallest number of the pieces that are one with this one by now.
  [[nodiscard]] std::uint32_t united(std::uint32_t piece) const { return pieces_.find(piece); }

 private:
  struct Loop {
    std::uint32_t size = 0, piece = 0;
  };

  [[nodiscard]] bool joins_own_piece(BorderEdgeId e, BorderEdgeId f) const {
    return edges_[e].loop != edges_[f].loop && piece(e) == piece(f);
  }
  void glue(BorderEdgeId x, BorderEdgeId y);
  void join_loops(BorderEdgeId x, BorderEdgeId y);
  void split_loop(BorderEdgeId s, BorderEdgeId t);
  void relabel(BorderEdgeId start, std::uint32_t loop);
  void unlist(BorderEdgeId e);

  std::vector<Edge> edges_;
  std::vector<BorderEdgeId> first_;  // of each vertex
  std::vector<Loop> loops_;          // empty: not labelled
  mutable DisjointSets pieces_;
  std::vector<VertexId> pinched_;  // by a fan that has closed; some more than once
  std::size_t handles_ = 0;
};

}  // namespace lodestone
