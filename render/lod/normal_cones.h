// Cells that turn their back: a cone around the normals of a cell's triangles, whatever their morph state
// (shirman1993), and whether a viewpoint sees all of them from behind.
//
// What bounds the normals of morphing triangles? A triangle is seen from behind iff D = det(n0 - v, n1 - v, n2 - v),
// n_i its drawn corners and v the viewpoint, is not negative, and D is linear in each corner. A corner is linear in its
// lambda. So D is linear in each of the three lambdas, and over all lambdas in [0, 1], one for each corner, it is
// least where every lambda is 0 or 1: a triangle that is seen from behind in all eight of these states is so in all
// others. Therefore a cone that holds the normals of the eight states bounds the triangle, however it morphs. States
// of no area have D = 0 and need no normal. Nothing less does: with two states (all at w, all at P(w)) triangles turn
// over in between.
//
// Many triangles have a state that is turned over (a vertex moves past a neighbour that stays), so that the cones of
// morphing cells are mostly wide. Those of cells that do not morph (lambda = 1) are kept apart.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Directions within an angle of less than 90 degrees from the axis.
struct NormalCone {
  Vec3f axis{0, 0, 1};                   // unit
  float sine = holds_all;                // of the angle, rounded up
  static constexpr float holds_all = 2;  // no such cone: every direction
};

// True if v sees all triangles with normals in the cone and corners in the box clearly from behind. Seen at less than
// about a degree from the side they count as seen from in front: along silhouettes the front and the back of a surface
// have nearly one depth.
[[nodiscard]] bool turns_its_back(const NormalCone& cone, Vec3f viewpoint, const Box3f& box);

class NormalCones {
 public:
  // Cones of all loaded cells; those of others contain every direction. O(triangles), in parallel; 48 bytes a cell.
  NormalCones(const Hierarchy& hierarchy, Scheduler& scheduler);

  // The same of the surface with all of its triangles turned over.
  void turn_over();

  // Cone of the cell's own triangles with lambda = 1.
  [[nodiscard]] const NormalCone& still(CellId cell) const { return cones_[cell].still; }
  // Cone of the cell's own triangles with any lambda.
  [[nodiscard]] const NormalCone& morphing(CellId cell) const { return cones_[cell].morphing; }
  // Cone of all triangles of the cell and of those below it, with any lambda.
  [[nodiscard]] const NormalCone& subtree(CellId cell) const { return cones_[cell].subtree; }

 private:
  struct Cones {
    NormalCone still, morphing, subtree;
  };
  std::vector<Cones> cones_;
};

}  // namespace lodestone
