// Points of a level of a progressive mesh by texture coordinates.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/id.h"
#include "core/progressive/mesh/progressive_mesh.h"
#include "core/spatial/box_tree.h"

namespace lodestone {

// A vertex on the texture: its coordinates and the number of its material.
[[nodiscard]] Vec3d on_texture(const ProgressiveMesh& mesh, VertexId vertex);
[[nodiscard]] std::array<Vec3d, 3> corners_on_texture(const ProgressiveMesh& mesh, const Triangle& t);

class LevelOnTexture {
 public:
  // The mesh has texture coordinates; both must outlive it.
  LevelOnTexture(const ProgressiveMesh& mesh, std::span<const Triangle> triangles);

  // From a point to the nearest one of the level that is at q on the texture; infinity if there is none.
  [[nodiscard]] double distance(Vec3d from, Vec3d q) const;

 private:
  [[nodiscard]] double distance(Vec3d from, Vec3d q, const Triangle& t) const;

  const ProgressiveMesh& mesh_;
  std::span<const Triangle> triangles_;
  BoxTree tree_;
};

}  // namespace lodestone
