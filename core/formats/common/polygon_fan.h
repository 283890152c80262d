// Turns polygons of mesh files, corner by corner, into triangles.
//
// A fan around the first corner: exact for convex polygons, and the same for every format and attribute. Nothing is
// stored but the first and the latest corner, so that a polygon may have any number of them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Corners are ids of any kind.
class TriangleFan {
 public:
  explicit TriangleFan(std::vector<Triangle>& triangles) : triangles_(&triangles) {}

  void add(std::uint32_t corner) {
    if (corners_ >= 2) triangles_->push_back({{first_, latest_, corner}});
    if (corners_ == 0) first_ = corner;
    latest_ = corner;
    ++corners_;
  }
  // Ends the polygon and returns its number of corners; the next add() begins another.
  std::uint64_t close() { return std::exchange(corners_, 0); }

 private:
  std::vector<Triangle>* triangles_;
  std::uint64_t corners_ = 0;
  std::uint32_t first_ = 0, latest_ = 0;
};

// Corners are vertices of a mesh; counts the faces that were dropped or triangulated.
class PolygonFan {
 public:
  explicit PolygonFan(RawMesh& mesh) : mesh_(&mesh), fan_(mesh.triangles) {}

  void add(std::uint32_t corner) { fan_.add(corner); }
  void close() {
    const std::uint64_t corners = fan_.close();
    if (corners < 3) ++mesh_->faces_dropped;
    if (corners > 3) ++mesh_->polygons_triangulated;
  }

 private:
  RawMesh* mesh_;
  TriangleFan fan_;
};

}  // namespace lodestone
