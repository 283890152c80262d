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

namespace lodestone {

class BorderLoops {
 public:
  static constexpr std::uint32_t none = 0xFFFF'FFFFu;

  struct Edge {
    std::uint32_t from = none, to = none;        // none: the edge was removed
    std::uint32_t next = none, previous = none;  // around the hole; none: outside of this part
    std::uint32_t sibling = none;                // another edge that leaves `from`
    std::uint32_t loop = none;                   // if labelled
    bool tried = false;                          // marks edges for the search for triangles
  };

  BorderLoops() = default;
  explicit BorderLoops(std::size_t vertices) : first_(vertices, none) {}

  std::uint32_t add_vertex();
  // No triangle may run along to -> from.
  std::uint32_t add_edge(std::uint32_t from, std::uint32_t to);
  void link(std::uint32_t edge, std::uint32_t next);
  // Takes the piece of surface of each edge, a number below `pieces`. Every edge must be linked.
  void label(std::span<const std::uint32_t> piece_of_edge, std::size_t pieces);

  [[nodiscard]] std::size_t edge_count() const { return edges_.size(); }  // also removed ones
  [[nodiscard]] const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  [[nodiscard]] bool alive(std::uint32_t e) const { return edges_[e].from != none; }
  [[nodiscard]] std::uint32_t first(std::uint32_t v) const { return first_[v]; }  // edge that leaves v
  [[nodiscard]] std::uint32_t find(std::uint32_t from, std::uint32_t to) const;
  // Vertices at which several fans may meet, ascending: several border edges leave them, or some did when a fan closed.
  [[nodiscard]] std::vector<std::uint32_t> pinched() const;
  void set_tried(std::uint32_t e, bool tried) { edges_[e].tried = tried; }

  // Triangle to -> from -> apex at an edge; neither from -> apex nor apex -> to may be taken by a triangle. The new
  // border edges from -> apex and apex -> to; none where they were glued.
  struct Sides {
    std::uint32_t left = none, right = none;
  };
  Sides add_triangle(std::uint32_t edge, std::uint32_t apex);

  // The fan between the edge that arrives before `edge` and `edge` itself gets a vertex of its own.
  void move_start(std::uint32_t edge, std::uint32_t vertex);

  // The edges that leave the vertex are removed, and with them the surface there.
  void forget(std::uint32_t vertex);

  // Labelled: whether add_triangle() would make a handle, or would touch another loop of the same piece, to which the
  // next triangle would be glued.
  [[nodiscard]] bool makes_handle(std::uint32_t edge, std::uint32_t apex) const;
  [[nodiscard]] std::size_t handles() const { return handles_; }  // made so far
  [[nodiscard]] std::uint32_t piece(std::uint32_t edge) const { return pieces_.find(loops_[edges_[edge].loop].piece); }
  // The smallest number of the pieces that are one with this one by now.
  [[nodiscard]] std::uint32_t united(std::uint32_t piece) const { return pieces_.find(piece); }

 private:
  struct Loop {
    std::uint32_t size = 0, piece = 0;
  };

  [[nodiscard]] bool joins_own_piece(std::uint32_t e, std::uint32_t f) const {
    return edges_[e].loop != edges_[f].loop && piece(e) == piece(f);
  }
  void glue(std::uint32_t x, std::uint32_t y);
  void join_loops(std::uint32_t x, std::uint32_t y);
  void split_loop(std::uint32_t s, std::uint32_t t);
  void relabel(std::uint32_t start, std::uint32_t loop);
  void unlist(std::uint32_t e);

  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_;
  std::vector<Loop> loops_;  // empty: not labelled
  mutable DisjointSets pieces_;
  std::vector<std::uint32_t> pinched_;  // by a fan that has closed; some more than once
  std::size_t handles_ = 0;
};

}  // namespace lodestone
