// Chooses how the sphere is turned before it is cut open, so that the cut is short and lies where few see it.
//
// The cut is an end of charts for every level of detail: vertices on it are doubled and collapse only along it. Images
// over the square have no seam there, so that existing chart borders are as good as any other place. The cost of a
// cut is its length on the surface, each part times its exposure: the share of the sky that is seen from there, and a
// constant, so that hidden length is not for free. Both are measured on samples of the surface over the square.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/affine.h"
#include "core/math/triangle.h"
#include "core/math/vec3.h"

namespace lodestone::spherical {

struct CutCost {
  double cost = 0;
  double length = 0;    // of the four arcs on the surface, in its units
  double exposure = 0;  // the mean along them, 0 to 1
};

class CutMeasure {
 public:
  // A closed mesh and its directions, as in unfold.h. 20 ms for meshes of up to 100,000 triangles. Throws InputError if
  // the triangles leave a part of the sphere uncovered.
  CutMeasure(std::span<const Vec3d> positions, std::span<const Triangle> triangles, std::span<const Vec3d> directions);

  // The cut after all directions have been turned by a rotation.
  [[nodiscard]] CutCost measure(const Affine3d& rotation) const;

 private:
  struct Sample {
    Vec3d position;
    double exposure = 0;
  };
  void find_exposure();
  [[nodiscard]] Sample at(Vec3d direction) const;

  std::vector<Sample> samples_;  // over the square, in cells
};

struct CutChoice {
  Affine3d rotation;
  CutCost cost, before;  // before: without a rotation
};
// The best of 768 rotations spread evenly, and of those reached from the best of them in smaller and smaller steps; no
// rotation if that is as good. A function of the mesh alone.
[[nodiscard]] CutChoice choose_cut(const CutMeasure& measure);

// Unit vectors. Triangles that are nearly degenerate on the sphere may be turned over by rounding.
[[nodiscard]] std::vector<Vec3d> rotated(std::span<const Vec3d> directions, const Affine3d& rotation);

}  // namespace lodestone::spherical
