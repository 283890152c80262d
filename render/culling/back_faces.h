// Tells if the back of a surface can be seen, and which cells need not be drawn if it cannot.
//
// From outside of a closed surface whose parts all face outwards, its back is never seen: every ray meets a front
// first. Where all of them face inwards the front is never seen. This holds for the drawn surface as for M_L, of which
// it is the image, unless it intersects itself. Closed: every half-edge has its twin, with multiplicity, so that a ray
// crosses as many fronts as backs.
#pragma once

#include <cstdint>
#include <vector>

#include "render/frame/appearance.h"
#include "render/lod/normal_cones.h"

namespace lodestone {

enum class Facing : std::uint8_t {
  open,     // M_L has a boundary, or cells of it are missing
  outward,  // closed; the volume within each connected part is positive
  inward,   // closed; negative for each
  mixed,    // closed; of both signs, as with a bubble in a solid, or without any volume
};

// The boundary is computed by a sum of hashes over half-edges in which twins cancel, positions of equal bits being one
// vertex: O(triangles of M_L), wrong with a probability of 2^-64. Closed surfaces take 12 bytes a vertex besides.
[[nodiscard]] Facing facing_of(const Hierarchy& hierarchy, Scheduler& scheduler);

// True if facing_of is not `open`; takes no memory.
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

  [[nodiscard]] Facing facing() const { return facing_; }
  // Cones of the side that is turned inwards, for SelectionConfig; null if it may be seen from the viewpoint: through
  // holes of masks, through glass, or because the other side is not drawn.
  [[nodiscard]] const NormalCones* cones_from(Vec3f viewpoint, const Appearance& appearance) const;

 private:
  Facing facing_;
  bool seen_through_, one_sided_;  // some of its materials
  OutsideSpace outside_;
  NormalCones cones_;
};

}  // namespace lodestone
