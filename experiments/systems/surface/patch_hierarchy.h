// Meshes as the cells of one level, which is the form that renderers draw.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Vertices with a normal each.
struct PatchMesh {
  std::span<const Vec3f> positions;
  std::span<const PackedNormal> normals;
  std::span<const Triangle> triangles;
};

// The first cell has no triangles: its box is that of the model, which cameras look at.
class PatchHierarchy {
 public:
  explicit PatchHierarchy(const Hierarchy& model);
  PatchHierarchy(const PatchHierarchy&) = delete;
  PatchHierarchy& operator=(const PatchHierarchy&) = delete;

  CellId add(const PatchMesh& mesh);  // copied
  void clear();                       // but for the first cell
  // Removes all cells, and adds the triangles of a mesh in cells of `run` each, in their order. Triangles side by side
  // should be near each other. Linear.
  std::vector<CellId> remake(const PatchMesh& mesh, std::size_t run = 2048);

  [[nodiscard]] const Hierarchy& hierarchy() const { return hierarchy_; }

 private:
  struct Payload {
    std::vector<Vec3f> positions;
    std::vector<PackedNormal> normals;
    std::vector<std::uint16_t> indices;  // one of these two is empty
    std::vector<Triangle> triangles;
  };
  Payload& next_payload();
  CellId add_cell(const Payload& payload);

  std::vector<Payload> payloads_;
  std::size_t used_ = 0;
  std::vector<std::uint32_t> number_;  // of vertices, within a run
  Hierarchy hierarchy_;
};

}  // namespace lodestone
