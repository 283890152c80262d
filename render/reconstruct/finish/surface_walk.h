// Walks from a triangle of a surface to the one nearest to a point, over vertices and edges that no seam of the texture
// cuts.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/id.h"
#include "core/math/vec3.h"

namespace lodestone {

class SurfaceWalk {
 public:
  // Takes a mesh by wedges: triangles that share an edge share its wedges, unless a seam lies there. Keeps the spans.
  // Memory: 4 bytes per wedge and 12 per triangle.
  SurfaceWalk(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

  // A place on the surface: shares of a triangle's corners that add up to 1, none below 0.
  struct Place {
    TriangleId triangle;
    std::array<double, 3> share{};
  };
  // The nearest place of the triangle, and of its neighbours as long as they are nearer to the point; at the end of a
  // chart or the surface, on its border. The place is never in another chart than `start`, and never beyond a
  // triangle's edge.
  [[nodiscard]] Place find(TriangleId start, Vec3d point) const;

 private:
  [[nodiscard]] std::array<Vec3d, 3> corners(TriangleId triangle) const;

  std::span<const Vec3f> positions_;
  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> first_;
  std::vector<TriangleId> around_;  // the triangles around each wedge
};

}  // namespace lodestone
