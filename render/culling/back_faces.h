// Tells if the back of a surface can be seen, and which cells need not be drawn if it cannot.
//
// From outside of a closed surface that is oriented outwards, its back is never seen: every ray meets a front first.
// This holds for the drawn surface as for M_L, of which it is the image, unless it intersects itself. Closed: every
// half-edge has its twin, with multiplicity, so that a ray crosses as many fronts as backs.
#pragma once

#include <cstdint>
#include <vector>

#include "render/lod/normal_cones.h"

namespace lodestone {

// True if the boundary of M_L is empty, positions of equal bits being one vertex, and its volume is positive. Computed
// by a sum of hashes over half-edges in which twins cancel: O(triangles of M_L), no memory; wrong with a probability of
// 2^-64. False if cells of M_L are missing.
[[nodiscard]] bool is_closed(const Hierarchy& hierarchy, Scheduler& scheduler);

// Viewpoints that are certainly outside of the surface, in whatever state it is drawn: their cell of a grid is joined
// to the space around the model by cells that no part of the surface can enter.
class OutsideSpace {
 public:
  // The surface does not meet a near plane whose corners are less than this from the viewpoint.
  static constexpr float clearance = 1.0f / 256;

  explicit OutsideSpace(const Hierarchy& hierarchy);
  [[nodiscard]] bool contains(Vec3f viewpoint) const;

 private:
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  }
  void mark(const Box3f& box);
  void fill();

  enum class Space : std::uint8_t { unknown, surface, outside };
  int side_ = 1;  // cells of the grid along each axis
  std::vector<Space> cells_;
};

// The data of one model. Reads all of it, in parallel.
class BackFaces {
 public:
  BackFaces(const Hierarchy& hierarchy, Scheduler& scheduler);

  [[nodiscard]] bool closed() const { return closed_; }
  // Cones for SelectionConfig; null if backs may be seen from the viewpoint.
  [[nodiscard]] const NormalCones* cones_from(Vec3f viewpoint) const {
    return closed_ && outside_.contains(viewpoint) ? &cones_ : nullptr;
  }

 private:
  bool closed_;
  OutsideSpace outside_;
  NormalCones cones_;
};

}  // namespace lodestone
