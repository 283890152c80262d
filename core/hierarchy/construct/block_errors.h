// The errors of the vertices that a block makes, their distances from the finest surface: those of their children and
// the distances of these from the coarser surface, added up vertex by vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/star_distance.h"
#include "core/simplify/contract/simplifier.h"

namespace lodestone {

class BlockErrors {
 public:
  // Takes the distances of the simplifier. If it has measured none, or doubtful ones, they are searched for here.
  // `triangles`: those that were simplified. All that is given must outlive add().
  void begin(const SimplifyResult& result, std::span<const Triangle> triangles);

  // To the errors of the parent's vertices, and to its own, those by way of a child, whose parents and largest
  // displacement are known. `block_id`: of each of its vertices.
  void add(const CellBuild& child, std::span<const std::uint32_t> block_id, CellBuild& parent);

 private:
  [[nodiscard]] float search(Vec3f from, VertexId vertex);

  const SimplifyResult* result_ = nullptr;
  bool searches_ = false;
  double largest2_ = 0;           // squared distance so far of a vertex, if it is searched for
  std::vector<Triangle> images_;  // of the triangles under P, degenerate ones included
  StarDistance surface_;          // of the images
};

// Those of the shared vertices of a cell with triangles: a triangle has the largest error of its corners.
void fill_border_errors(CellBuild& cell);

}  // namespace lodestone
