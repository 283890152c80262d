// The surface of a level of a hierarchy as something to search: a bounding volume hierarchy for each cell, and one over
// the cells.
//
// Positions stay where they are, in the cells. Boxes of both children in one node, exact in float; distances are
// double. About 25 bytes per triangle. Built cell by cell, so that who has several workers may use them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/math/box3.h"

namespace lodestone {

// What a surface consists of: the triangles of the cells, and as a point each vertex that no triangle of its cell uses.
// Those are what is left of a part of the surface that has collapsed altogether.
struct SurfaceItem {
  std::uint32_t cell = no_cell;  // index in Hierarchy::cells; no_cell: none
  std::uint32_t number = 0;      // a triangle of the cell, or that many of them plus a vertex
};

class LevelSurface {
 public:
  using Corners = std::array<Vec3d, 3>;  // three times the same place for a point

  struct Nearest {
    double squared_distance = 0;
    SurfaceItem item;
  };

  // Keeps a reference to the hierarchy, whose payloads must stay.
  LevelSurface(const Hierarchy& hierarchy, int level);
  // Cells are counted from the first one of the level. Every cell once, several at once if you like; then the rest.
  [[nodiscard]] std::uint32_t cell_count() const { return static_cast<std::uint32_t>(trees_.size()); }
  void build_cell(std::uint32_t cell);
  void build_rest();

  // The nearest item. hint: one that may be near, which makes queries on coherent points several times faster. enough:
  // any item within this squared distance will do.
  [[nodiscard]] Nearest nearest(Vec3d p, SurfaceItem hint = {}, double enough = 0) const;
  [[nodiscard]] Corners corners(SurfaceItem item) const;
  // Adds the items whose boxes are within `distance` of the box, at least; ends early with more than `most`.
  void gather(const Box3f& box, double distance, std::size_t most, std::vector<SurfaceItem>& items) const;

  // What a branch of the tree of a cell holds, for who walks it: a leaf has items, any other two branches.
  struct Branch {
    std::uint32_t cell = 0;  // counted from the first one of the level
    std::uint32_t child = 0;
    Box3f box;
  };
  static constexpr std::uint32_t leaf_bit = 0x8000'0000u;
  [[nodiscard]] Branch cell_branch(std::uint32_t cell) const { return {cell, trees_[cell].root, trees_[cell].box}; }
  [[nodiscard]] static bool is_leaf(const Branch& branch) { return (branch.child & leaf_bit) != 0; }
  [[nodiscard]] std::array<Branch, 2> halves(const Branch& branch) const;
  // Calls visit(item) for every triangle of a leaf; points are passed over.
  template <class Visit>
  void for_each_triangle(const Branch& leaf, const Visit& visit) const {
    const Tree& tree = trees_[leaf.cell];
    const std::uint32_t first = leaf_first(leaf.child), end = first + leaf_count(leaf.child);
    for (std::uint32_t i = first; i < end; ++i)
      if (tree.items[i] < cells_[leaf.cell].triangles.size())
        visit(SurfaceItem{first_cell_ + leaf.cell, tree.items[i]});
  }

 private:
  // A child is a node number, or a leaf: the top bit, number of the first item, count - 1 in the low two bits; in the
  // tree over the cells, the cell.
  struct Node {
    Box3f box[2];
    std::uint32_t child[2]{};
  };
  struct Tree {
    std::vector<Node> nodes;
    std::vector<std::uint32_t> items;  // numbers, as in SurfaceItem
    std::uint32_t root = 0;
    Box3f box;
  };
  struct Part {
    Box3f box;
    std::uint32_t number = 0;
  };
  class Builder;
  struct Waiting;
  [[nodiscard]] static constexpr std::uint32_t leaf_first(std::uint32_t leaf) { return (leaf & ~leaf_bit) >> 2; }
  [[nodiscard]] static constexpr std::uint32_t leaf_count(std::uint32_t leaf) { return (leaf & 3) + 1; }
  void search_cell(std::uint32_t cell, Vec3d p, double enough, Nearest& best) const;
  [[nodiscard]] Box3f box_of(std::uint32_t cell, std::uint32_t number) const;
  void gather_cell(std::uint32_t cell, const Box3f& box, std::size_t most, std::vector<SurfaceItem>& items) const;
  void take(std::uint32_t cell, std::uint32_t number, Vec3d p, Nearest& best) const;

  std::span<const Cell> cells_;
  std::uint32_t first_cell_;
  std::vector<Tree> trees_;  // by cell
  Tree top_;                 // over the cells: one item per leaf
};

}  // namespace lodestone
