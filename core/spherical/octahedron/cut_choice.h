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
#include "core/math/vec3.h"

namespace lodestone::spherical {

struct CutCost {
  double cost = 0;
  double length = 0;    // of the four arcs on the surface, in its units
  double exposure = 0;  // the mean along them, 0 to 1
};

struct CutChoice {
  Affine3d rotation;
  CutCost cost, before;  // before: without a rotation
};

class CutMeasure {
 public:
  // A closed mesh and its directions, as in unfold.h. Up to 16,000 triangles have a sample of the surface for four of
  // them, larger meshes one grid of 64 x 64; time in proportion. Throws InputError if the triangles leave a part of the
  // sphere uncovered.
  CutMeasure(std::span<const Vec3d> positions, std::span<const Triangle> triangles, std::span<const Vec3d> directions);

  // The cut after all directions have been turned by a rotation.
  [[nodiscard]] CutCost measure(const Affine3d& rotation) const { return measure(rotation, 1); }
  // The best of rotations spread evenly, up to 768 of them, and of those reached from the best of them in smaller and
  // smaller steps; no rotation if that is as good. A function of the mesh alone.
  [[nodiscard]] CutChoice choose() const;

 private:
  struct Sample {
    Vec3d position;
    double exposure = 0;
  };
  struct ArcStep {
    double sine = 0, cosine = 0;
  };
  void find_exposure();
  [[nodiscard]] std::size_t number_of(std::int64_t x, std::int64_t y) const;
  [[nodiscard]] Sample at(Vec3d direction) const;
  [[nodiscard]] CutCost measure(const Affine3d& rotation, std::size_t stride) const;
  void improve(CutChoice& choice) const;

  std::uint32_t side_;           // samples along the square
  std::vector<Sample> samples_;  // over it, in cells
  std::vector<ArcStep> arc_;     // after its first point
};

// Unit vectors. Triangles that are nearly degenerate on the sphere may be turned over by rounding.
[[nodiscard]] std::vector<Vec3d> rotated(std::span<const Vec3d> directions, const Affine3d& rotation);

}  // namespace lodestone::spherical
