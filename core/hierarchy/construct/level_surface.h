// The surface of a level of a hierarchy as a search structure: a BoxTree for each cell, and one over the cells.
//
// Long triangles enter the searches as several boxes (core/spatial/part_boxes.h), so that a search visits few others.
// Positions remain in the cells. About 25 bytes per triangle, four times that where all of them are needles, seven
// times where these lie side by side. Built cell by cell, so that a caller with several workers can use them.
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
    std::uint32_t tested = 0;  // items: the work of the search
    bool complete = true;      // false: it ended at the most items; the item is near, but may not be the nearest
  };
  // When a search may end early.
  struct Until {
    double enough = 0;         // squared distance within which any item will do
    std::uint32_t most = ~0u;  // items tested
  };

  // Keeps a reference to the hierarchy, whose payloads must remain valid.
  LevelSurface(const Hierarchy& hierarchy, int level);
  // Every cell of the level is built once, in any order and on any thread; after all of them, the rest.
  [[nodiscard]] std::uint32_t cell_count() const { return static_cast<std::uint32_t>(trees_.size()); }
  [[nodiscard]] std::size_t triangle_count(CellRank cell) const { return cells_[cell].triangles.size(); }
  void build_cell(CellRank cell);
  void build_rest();

  // The nearest item. hint: one that may be near, which makes queries on coherent points several times faster.
  [[nodiscard]] Nearest nearest(Vec3d p, SurfaceItem hint, const Until& until) const;
  [[nodiscard]] Nearest nearest(Vec3d p, SurfaceItem hint = {}) const { return nearest(p, hint, Until{}); }
  [[nodiscard]] Corners corners(SurfaceItem item) const;
  struct Gathered {
    std::size_t tested = 0;  // items
    bool complete = true;    // false: there are more than `limit`, or to find them takes many tests
  };
  // Adds at least the items within `distance` of the box.
  Gathered gather(const Box3f& box, double distance, std::size_t limit, std::vector<SurfaceItem>& items) const;

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
  // The tree to search in, where an item may be in several leaves.
  [[nodiscard]] const BoxTree& parts(CellRank cell) const {
    return parts_[cell].items().empty() ? trees_[cell] : parts_[cell];
  }

  std::span<const Cell> cells_;
  const Level& level_;
  std::vector<BoxTree> trees_;  // by cell; each item is in one leaf
  std::vector<BoxTree> parts_;  // likewise, with the parts of long triangles; empty where there are none
  BoxTree top_;                 // over the cells, one per leaf
};

}  // namespace lodestone
