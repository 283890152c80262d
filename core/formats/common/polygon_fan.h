// Turns polygons of mesh files, corner by corner, into triangles.
//
// First each becomes a fan around its first corner, the same for every format and attribute. Fans are right for convex
// polygons; the others are cut anew once all positions are known (core/mesh/polygons.h), as vertices may come after
// faces.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/mesh/polygons.h"

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

// Corners are vertices of a mesh; counts the faces that were dropped or triangulated. One object for all faces of a
// file.
class PolygonFan {
 public:
  explicit PolygonFan(RawMesh& mesh) : mesh_(&mesh), fan_(mesh.triangles) {}

  void add(std::uint32_t corner) { fan_.add(corner); }
  void close() {
    const std::uint64_t corners = fan_.close();
    if (corners < 3) ++mesh_->faces_dropped;
    if (corners > 3) keep(corners);
  }
  // After the last face. `values`: of the same corners, also as fans, one for each triangle of the mesh.
  void cut(std::span<const std::span<Triangle>> values = {}) {
    cut_fans(mesh_->positions, runs_, mesh_->triangles, values);
  }

 private:
  void keep(std::uint64_t corners) {
    ++mesh_->polygons_triangulated;
    const std::size_t first = mesh_->triangles.size() - (corners - 2);
    const bool continues = !runs_.empty() && runs_.back().corners == corners && runs_.back().end() == first;
    if (!continues) runs_.push_back({first, 0, corners});
    ++runs_.back().polygons;
  }

  RawMesh* mesh_;
  TriangleFan fan_;
  std::vector<FanRun> runs_;
};

}  // namespace lodestone
