// The items of a surface around a place as a flat array: for many queries of points that are close together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hierarchy/construct/level_surface.h"
#include "core/math/lanes/float4.h"

namespace lodestone {

class Neighbourhood {
 public:
  struct Nearest {
    double distance = 0;
    std::uint32_t number = 0;
  };

  // Gathers the items within `reach` of the box, and some more. False if there are more than `limit`, or hard to find:
  // then the neighbourhood must not be used.
  bool gather(const LevelSurface& surface, const Box3f& box, double reach, std::size_t limit);

  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] std::size_t tested() const { return tested_; }  // items, by the last gather()
  [[nodiscard]] double reach() const { return reach_; }
  // The nearest of the items; for a point of the box it is the nearest one of the surface if its distance is within
  // reach(). `hint` starts the search. size() > 0.
  [[nodiscard]] Nearest nearest(Vec3d p, std::uint32_t hint) const;
  [[nodiscard]] const LevelSurface::Corners& corners(std::uint32_t number) const { return corners_[number]; }
  [[nodiscard]] SurfaceItem item(std::uint32_t number) const { return items_[number]; }

 private:
  // Four items in single precision, relative to the middle of the box: first corner, two edges, normal.
  struct Group {
    Float4x3 corner, ab, ac, normal;
    Int4 thin;        // the plane is unknown in single precision: distances are those of the sides
    Int4 degenerate;  // with a side of no length: distances are 0
    Float4 within;    // of a side are the points of a thin one; 0 for others
  };
  void add_group(std::size_t first);
  [[nodiscard]] static Float4 squared_distances(const Group& group, const Float4x3& p);

  double reach_ = 0;
  std::size_t tested_ = 0;
  float slack_ = 0;  // upper bound of the rounding error of a distance
  Vec3d middle_;
  std::vector<SurfaceItem> items_;
  std::vector<LevelSurface::Corners> corners_;
  std::vector<Group> groups_;
};

}  // namespace lodestone
