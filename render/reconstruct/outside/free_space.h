// The space that views see to be free: all that lies between an eye and the first surface (space carving, after
// kutulakos2000, with exact depths in place of photographs).
//
// A point is free if any view sees past it. Depth is known at pixel centres and continued in the tangent plane of each;
// a view vouches for a point only if all four pixels around it do, so that a silhouette is never cut into, and a slit
// narrower than a pixel is closed. Each map shows the whole model: what lies beside it is free.
//
// A view that sees the back of a surface looks through a hole. Where few pixels do, the surface is a solid's with holes
// (a scan that was not closed) and such pixels vouch for nothing, so that the holes are closed; where many do, it is a
// sheet with two sides, or is not oriented. A place whose back alone is seen is that of a part turned inside out.
#pragma once

#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/merge/ownership.h"

namespace lodestone {

// The sample of the surface that tells best where it is near some point.
struct SurfaceHit {
  ViewNumber view = no_view;  // no_view: no sample is near
  std::uint32_t pixel = 0;
  Vec3f normal;         // towards the eye
  double distance = 0;  // of the point from the sample's tangent plane; positive on the side of the eye
};

class FreeSpace {
 public:
  // Maps with a near plane are not used. `reach`: distances beyond it are not told apart; normalised units.
  FreeSpace(std::span<const PositionMap> maps, double reach, Scheduler& scheduler);

  enum class State : std::uint8_t { free, solid, mixed };
  // State of a whole box. If it is mixed, `views` lists those that decide it.
  [[nodiscard]] State classify(const Box3f& box, std::vector<ViewNumber>& views) const;
  // Distance of a point from the border of the free space, in [-reach, reach], by these views; positive: it is free.
  [[nodiscard]] double distance(Vec3d p, std::span<const ViewNumber> views) const;
  [[nodiscard]] SurfaceHit nearest(Vec3d p, std::span<const ViewNumber> views) const;
  // True if a pixel of a map sees the back of the surface through a hole.
  [[nodiscard]] bool is_back(std::size_t view, std::size_t pixel) const {
    return sides_[view][pixel] == Side::back_through_hole;
  }
  [[nodiscard]] std::span<const PositionMap> maps() const { return maps_; }

 private:
  struct Range {
    float least, largest;
  };
  // Depths of squares of pixels: level k holds squares of side 4 * 2^k. Background is infinitely far.
  struct Level {
    int width = 0, height = 0;
    PixelArray<Range> depths;
  };
  struct Footprint;
  // Which side of the surface a pixel sees.
  enum class Side : std::uint8_t { front, back, back_through_hole };
  void find_backs(Scheduler& scheduler);
  void find_holes(Scheduler& scheduler);
  // Normal of what a pixel sees, on the side of the eye; zero where the triangle has none.
  [[nodiscard]] Vec3f normal_towards_eye(std::size_t view, std::size_t pixel) const {
    const Vec3f normal = maps_[view].normal[pixel];
    return sides_[view][pixel] == Side::front ? normal : -1.0f * normal;
  }
  template <class DepthsAt>
  [[nodiscard]] static Level coarser(int width, int height, const PixelGroups& groups, int side,
                                     const DepthsAt& depths_at);
  void make_levels(std::size_t view);
  [[nodiscard]] Footprint footprint(const MapView& view, const Box3f& box) const;
  [[nodiscard]] Range depths_in(std::size_t view, const Footprint& print) const;
  [[nodiscard]] double distance_in(std::size_t view, Vec3d p) const;

  std::span<const PositionMap> maps_;
  double reach_;
  std::vector<PixelArray<Side>> sides_;     // of each map
  std::vector<std::vector<Level>> levels_;  // of each map; empty: not used
};

}  // namespace lodestone
