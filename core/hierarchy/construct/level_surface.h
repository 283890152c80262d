// The surface of a level of a hierarchy as a search structure: a BoxTree for each cell, and one over the cells.
//
// Positions remain in the cells. About 25 bytes per triangle. Built cell by cell, so that a caller with several workers
// can use them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/spatial/box_tree.h"

namespace lodestone {

// An element of a surface: a triangle of a cell, or, as a point, a vertex that no triangle of its cell uses. Such
// points are the remains of a part of the surface that has collapsed altogether.
struct SurfaceItem {
  CellId cell = no_cell;     // no_cell: none
  std::uint32_t number = 0;  // a triangle of the cell; from the number of triangles on, a vertex
};

class LevelSurface {
 public:
  using Corners = std::array<Vec3d, 3>;  // a point has three equal corners

  struct Nearest {
    double squared_distance = 0;
    SurfaceItem item;
  };

  // Keeps a reference to the hierarchy, whose payloads must remain valid.
  LevelSurface(const Hierarchy& hierarchy, int level);
  // Every cell of the level is built once, in any order and on any thread; after all of them, the rest.
  [[nodiscard]] std::uint32_t cell_count() const { return static_cast<std::uint32_t>(trees_.size()); }
  void build_cell(CellRank cell);
  void build_rest();

  // The nearest item. hint: one that may be near, which makes queries on coherent points several times faster. enough:
  // any item within this squared distance may be returned.
  [[nodiscard]] Nearest nearest(Vec3d p, SurfaceItem hint = {}, double enough = 0) const;
  [[nodiscard]] Corners corners(SurfaceItem item) const;
  // Adds at least the items whose boxes are within `distance` of the box; stops after `limit` items.
  void gather(const Box3f& box, double distance, std::size_t limit, std::vector<SurfaceItem>& items) const;

  // A subtree of the tree of a cell.
  struct Branch {
    CellRank cell;
    BoxTree::Branch tree;
  };
  [[nodiscard]] Branch cell_branch(CellRank cell) const { return {cell, trees_[cell].root()}; }
  [[nodiscard]] std::array<Branch, 2> halves(const Branch& branch) const {
    const auto [left, right] = trees_[branch.cell].halves(branch.tree);
    return {Branch{branch.cell, left}, Branch{branch.cell, right}};
  }
  // Calls visit(item) for every triangle of a leaf, not for points.
  template <class Visit>
  void for_each_triangle(const Branch& leaf, const Visit& visit) const {
    const BoxTree::Slots slots = BoxTree::slots(leaf.tree);
    for (std::uint32_t i = slots.begin; i < slots.end; ++i)
      if (const std::uint32_t number = trees_[leaf.cell].items()[i]; number < cells_[leaf.cell].triangles.size())
        visit(SurfaceItem{level_.id_of(leaf.cell), number});
  }

 private:
  [[nodiscard]] Box3f box_of(CellRank cell, std::uint32_t number) const;
  void take(CellRank cell, std::uint32_t number, Vec3d p, Nearest& best) const;

  std::span<const Cell> cells_;
  const Level& level_;
  std::vector<BoxTree> trees_;  // by cell
  BoxTree top_;                 // over the cells, one per leaf
};

}  // namespace lodestone
