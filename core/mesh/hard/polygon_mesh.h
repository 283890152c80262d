// Surfaces as a file may hold them: doubles that need not be finite, polygons that need not be triangles.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

struct PolygonMesh {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> corners;  // of all polygons
  std::vector<std::size_t> ends;       // of each polygon, in corners

  [[nodiscard]] std::size_t polygon_count() const { return ends.size(); }
  // Those that the polygons are cut into; each has at least three corners.
  [[nodiscard]] std::size_t triangle_count() const { return corners.size() - 2 * ends.size(); }
  std::uint32_t add_vertex(Vec3d p) {
    positions.push_back(p);
    return static_cast<std::uint32_t>(positions.size() - 1);
  }
  void add_face(std::initializer_list<std::uint32_t> face) {
    corners.insert(corners.end(), face);
    ends.push_back(corners.size());
  }
};

}  // namespace lodestone
