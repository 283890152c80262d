// The items of a surface around a place, side by side: for many questions about points that are close together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hierarchy/build/level_surface.h"
#include "core/math/float4.h"

namespace lodestone {

class Neighbourhood {
 public:
  struct Nearest {
    double distance = 0;
    std::uint32_t number = 0;
  };

  // The items whose boxes are within `reach` of the box, and some more. False when there are more than `most`: then the
  // neighbourhood is of no use.
  bool gather(const LevelSurface& surface, const Box3f& box, double reach, std::size_t most);

  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] double reach() const { return reach_; }
  // The nearest of the items: that of the surface where it is within reach of a point of the box. `hint` starts the
  // search. size() > 0.
  [[nodiscard]] Nearest nearest(Vec3d p, std::uint32_t hint) const;
  [[nodiscard]] const LevelSurface::Corners& corners(std::uint32_t number) const { return corners_[number]; }
  [[nodiscard]] SurfaceItem item(std::uint32_t number) const { return items_[number]; }

 private:
  // Four items in single precision, relative to the middle of the box: first corner, two edges, normal.
  struct Group {
    Float4x3 corner, ab, ac, normal;
    Int4 unsafe;  // so thin that single precision knows nothing of it
  };
  void add_group(std::size_t first);
  [[nodiscard]] static Float4 squared_distances(const Group& group, const Float4x3& p);

  double reach_ = 0;
  float slack_ = 0;  // above what rounding may change a distance by
  Vec3d middle_;
  std::vector<SurfaceItem> items_;
  std::vector<LevelSurface::Corners> corners_;
  std::vector<Group> groups_;
};

}  // namespace lodestone
