// Polygons of mesh files, corner by corner, into the triangles of a RawMesh.
//
// A fan around the first corner: exact for convex polygons, and the same for every format. Nothing is stored but the
// first and the latest corner, so that a polygon may have any number of them.
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

class PolygonFan {
 public:
  explicit PolygonFan(RawMesh& mesh) : mesh_(&mesh) {}

  void add(std::uint32_t corner) {
    if (corners_ >= 2) mesh_->triangles.push_back({{first_, latest_, corner}});
    if (corners_ == 0) first_ = corner;
    latest_ = corner;
    ++corners_;
  }
  // Ends the polygon and counts what was done; the next add() begins another.
  void close() {
    if (corners_ < 3) ++mesh_->faces_dropped;
    if (corners_ > 3) ++mesh_->polygons_triangulated;
    corners_ = 0;
  }

 private:
  RawMesh* mesh_;
  std::uint64_t corners_ = 0;
  std::uint32_t first_ = 0, latest_ = 0;
};

}  // namespace lodestone
