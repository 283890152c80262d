// A hierarchy in the memory of the graphics device.
//
// Per vertex 20 bytes: position (three tightly packed floats, read as float[]), packed normal (one uint), parent (one
// uint, local to the parent cell); per triangle 12 bytes. The vertices of a group are bound twice: as attributes for
// the vertex itself, as storage blocks for its parent.
#pragma once

#include <vector>

#include "core/hierarchy/hierarchy.h"
#include "render/backends/gl/gl_groups.h"
#include "render/backends/gl/gl_object.h"

namespace lodestone {

class GlScene {
 public:
  // Copies everything; keeps a reference to the hierarchy for its cell table. Throws ResourceError when the memory of
  // the device does not suffice.
  GlScene(const Hierarchy& hierarchy, std::size_t max_storage_block_bytes);

  [[nodiscard]] const Hierarchy& hierarchy() const { return hierarchy_; }
  [[nodiscard]] const CellPlace& place(std::uint32_t cell) const { return places_[cell]; }
  [[nodiscard]] std::size_t group_count() const { return groups_.size(); }

  // Binds the vertex array and the storage blocks of a group; draw records come from `records`.
  void bind(std::uint32_t group, const GlBuffer& records) const;

 private:
  struct Group {
    GlBuffer positions, normals, parents, indices;
    GlVertexArray vertex_array;
  };
  [[nodiscard]] Group upload(const CellGroup& group) const;

  const Hierarchy& hierarchy_;
  std::vector<CellPlace> places_;
  std::vector<Group> groups_;
};

}  // namespace lodestone
