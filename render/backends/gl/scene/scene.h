// Hierarchies, or parts of them, in the memory of the graphics device.
//
// A vertex takes 21 bytes: position (three tightly packed floats, read as float[]), packed normal (one uint), parent
// (one uint, local to the parent cell), place of its signature; a triangle takes 12 bytes. Models that have them add
// texture coordinates (two floats), colour (four bytes) and material (one uint). The vertices of a group are bound
// twice: as attributes for the vertex itself, as storage blocks for its parent.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/model/signatures.h"
#include "render/backends/gl/device/object.h"
#include "render/backends/gl/device/stream.h"
#include "render/backends/gl/scene/places.h"

namespace lodestone {

class GlScene {
 public:
  // Nothing is copied yet; the hierarchies must outlive the scene.
  GlScene(std::span<const Hierarchy* const> models, std::size_t max_storage_block_bytes,
          const std::vector<GroupSize>& expected);

  // Copies a family whose arrays its hierarchy has just got. Throws ResourceError when the memory of the device does
  // not suffice.
  void add(FamilyId family);
  void remove(FamilyId family) { places_.remove(family); }
  // Adaptive radii: the vertices of the model get the places of these signatures, unless they have them already.
  void set_signatures(std::uint32_t model, const std::shared_ptr<const Signatures>& signatures);

  [[nodiscard]] const Hierarchy& hierarchy(std::uint32_t model) const { return *models_[model]; }
  [[nodiscard]] std::size_t model_count() const { return models_.size(); }
  [[nodiscard]] const CellPlace& place(std::uint32_t model, CellId cell) const { return places_.place(model, cell); }
  [[nodiscard]] std::size_t group_count() const { return groups_.size(); }

  // Binds the vertex array and the storage blocks of a group; draw records come from `records`.
  void bind(std::uint32_t group, const GlRange& records) const;

 private:
  struct Group {
    GlBuffer positions, normals, parents, signature_places, indices;
    GlBuffer uv, colours, materials;  // empty where the models have none
    AttributeSet attributes;
    GlVertexArray vertex_array;
  };
  [[nodiscard]] static Group make_group(GroupSize size, AttributeSet attributes);
  void copy_signature_places(FamilyId family);

  std::vector<const Hierarchy*> models_;
  std::vector<std::shared_ptr<const Signatures>> signatures_;  // by model; null until they are set
  GlPlaces places_;
  std::vector<Group> groups_;
};

// Slots that all families of a hierarchy take together.
[[nodiscard]] GroupSize size_of_all(const Hierarchy& hierarchy);

}  // namespace lodestone
