// A hierarchy in the memory of the graphics device, or the part of it that is there.
//
// Per vertex 20 bytes: position (three tightly packed floats, read as float[]), packed normal (one uint), parent (one
// uint, local to the parent cell); per triangle 12 bytes. The vertices of a group are bound twice: as attributes for
// the vertex itself, as storage blocks for its parent.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/hierarchy.h"
#include "render/backends/gl/gl_object.h"
#include "render/backends/gl/gl_places.h"

namespace lodestone {

class GlScene {
 public:
  // Nothing is copied yet; keeps a reference to the hierarchy.
  GlScene(const Hierarchy& hierarchy, std::size_t max_storage_block_bytes, GroupSize expected);

  // Copies the children of `parent` (no_cell: the root), which the hierarchy has just got. Throws ResourceError when
  // the memory of the device does not suffice.
  void add(std::uint32_t parent);
  void remove(std::uint32_t parent) { places_.remove(parent); }

  [[nodiscard]] const Hierarchy& hierarchy() const { return hierarchy_; }
  [[nodiscard]] const CellPlace& place(std::uint32_t cell) const { return places_.place(cell); }
  [[nodiscard]] std::size_t group_count() const { return groups_.size(); }

  // Binds the vertex array and the storage blocks of a group; draw records come from `records`.
  void bind(std::uint32_t group, const GlBuffer& records) const;

 private:
  struct Group {
    GlBuffer positions, normals, parents, indices;
    GlVertexArray vertex_array;
  };
  [[nodiscard]] static Group make_group(GroupSize size);

  const Hierarchy& hierarchy_;
  GlPlaces places_;
  std::vector<Group> groups_;
};

// What all families of a hierarchy take together.
[[nodiscard]] GroupSize size_of_all(const Hierarchy& hierarchy);

}  // namespace lodestone
