#include "render/backends/gl/scene/scene.h"

#include <algorithm>

#include "core/hierarchy/lode/lode_payload.h"
#include "render/backends/gl/device/device.h"
#include "render/backends/gl/shaders/draw_program.h"

namespace lodestone {
namespace {

constexpr const char* uploading = "uploading the hierarchy";

// Storage that families are copied into as they come.
void allocate(const GlBuffer& buffer, std::uint64_t bytes) {
  const auto size = static_cast<GLsizeiptr>(std::max<std::uint64_t>(bytes, 4));  // no empty buffers in OpenGL
  glNamedBufferStorage(buffer.name(), size, nullptr, GL_DYNAMIC_STORAGE_BIT);
  check_memory(uploading);
}

template <class T>
void copy(const GlBuffer& buffer, std::uint64_t first, std::span<const T> values, std::size_t item_bytes = sizeof(T)) {
  if (values.empty()) return;
  glNamedBufferSubData(buffer.name(), static_cast<GLintptr>(first * item_bytes),
                       static_cast<GLsizeiptr>(values.size_bytes()), values.data());
}

template <class T>
void copy(const GlBuffer& buffer, std::uint64_t first, const IndexView<T>& indices,
          std::size_t item_bytes = sizeof(T)) {
  std::vector<T> room;
  copy(buffer, first, indices.widened(room), item_bytes);
}

// Four bytes are read as numbers in [0, 1].
void set_attribute(GLuint array, GLuint attribute, GLint count, GLenum type) {
  glEnableVertexArrayAttrib(array, attribute);
  glVertexArrayAttribBinding(array, attribute, attribute);
  const bool bytes = type == GL_UNSIGNED_BYTE && count == 4;
  if (type == GL_FLOAT || bytes)
    glVertexArrayAttribFormat(array, attribute, count, type, bytes, 0);
  else
    glVertexArrayAttribIFormat(array, attribute, count, type, 0);
}

}  // namespace

GroupSize size_of_all(const Hierarchy& hierarchy) {
  GroupSize all = GlPlaces::family_size(hierarchy, no_cell);
  for (CellId c{0}; c < hierarchy.cells.size(); ++c) {
    if (hierarchy.cells[c].child_count == 0) continue;
    const GroupSize family = GlPlaces::family_size(hierarchy, c);
    all = {all.vertices + family.vertices, all.indices + family.indices};
  }
  return all;
}

GlScene::GlScene(std::span<const Hierarchy* const> models, std::size_t max_storage_block_bytes,
                 const std::vector<GroupSize>& expected)
    : models_(models.begin(), models.end()),
      signatures_(models.size()),
      places_(models_, max_storage_block_bytes / sizeof(Vec3f), expected) {}

void GlScene::add(FamilyId id) {
  const Hierarchy& model = *models_[id.model];
  const FamilyPlace& family = places_.add(id);
  if (groups_.size() < places_.groups().size())
    groups_.push_back(make_group(places_.groups().back(), places_.attributes(family.group)));
  const Group& group = groups_[family.group];
  const auto copy_vertices = [&](const Cell& cell, std::uint64_t first) {
    copy(group.positions, first, cell.positions);
    copy(group.normals, first, cell.normals);
    copy(group.uv, first, cell.attributes.uv);
    copy(group.colours, first, cell.attributes.colours);
  };
  if (id.parent != no_cell) copy_vertices(model.cells[id.parent], family.first_vertex);
  const FamilyCells range = family_cells(model, id.parent);
  for (CellId c = range.begin; c < range.end; ++c) {
    const Cell& cell = model.cells[c];
    const CellPlace& place = places_.place(id.model, c);
    copy_vertices(cell, place.first_vertex);
    copy(group.parents, place.first_vertex, cell.parents);
    copy(group.materials, place.first_vertex, cell.attributes.materials);
    copy(group.indices, place.first_index, cell.triangles, sizeof(std::uint32_t));
  }
  if (signatures_[id.model]) copy_signature_places(id);
}

void GlScene::set_signatures(std::uint32_t model, const std::shared_ptr<const Signatures>& signatures) {
  if (signatures_[model] == signatures) return;
  signatures_[model] = signatures;
  for (const FamilyId family : places_.families())
    if (family.model == model) copy_signature_places(family);
}

void GlScene::copy_signature_places(FamilyId id) {
  const Hierarchy& model = *models_[id.model];
  const FamilyCells range = family_cells(model, id.parent);
  std::vector<std::uint8_t> of_cell;
  for (CellId c = range.begin; c < range.end; ++c) {
    of_cell.assign(model.cells[c].first_shared(), 0);
    const std::span<const std::uint8_t> shared = signatures_[id.model]->places(c);
    of_cell.insert(of_cell.end(), shared.begin(), shared.end());
    const CellPlace& place = places_.place(id.model, c);
    copy(groups_[place.group].signature_places, place.first_vertex, std::span<const std::uint8_t>(of_cell));
  }
}

// The copies of parents are not drawn, and the root has no parents: their slots among the parents are never read.
GlScene::Group GlScene::make_group(GroupSize size, AttributeSet attributes) {
  Group made;
  const GLuint array = made.vertex_array.name();
  const auto add = [&](const GlBuffer& buffer, GLuint attribute, GLint count, GLenum type, std::size_t bytes) {
    allocate(buffer, size.vertices * bytes);
    set_attribute(array, attribute, count, type);
    glVertexArrayVertexBuffer(array, attribute, buffer.name(), 0, static_cast<GLsizei>(bytes));
  };
  add(made.positions, own_position, 3, GL_FLOAT, sizeof(Vec3f));
  add(made.normals, own_normal, 2, GL_SHORT, sizeof(PackedNormal));
  add(made.parents, parent_index, 1, GL_UNSIGNED_INT, sizeof(std::uint32_t));
  add(made.signature_places, signature_place, 1, GL_UNSIGNED_BYTE, 1);
  if (attributes.uv) add(made.uv, own_uv, 2, GL_FLOAT, sizeof(Vec2f));
  if (attributes.colours) add(made.colours, own_colour, 4, GL_UNSIGNED_BYTE, sizeof(Rgba8));
  if (attributes.materials) add(made.materials, own_material, 1, GL_UNSIGNED_INT, sizeof(std::uint32_t));
  set_attribute(array, draw_record, 4, GL_UNSIGNED_INT);
  glVertexArrayBindingDivisor(array, draw_record, 1);
  allocate(made.indices, size.indices * sizeof(std::uint32_t));
  glVertexArrayElementBuffer(array, made.indices.name());
  made.attributes = attributes;
  return made;
}

void GlScene::bind(std::uint32_t group, const GlRange& records) const {
  const Group& g = groups_[group];
  glVertexArrayVertexBuffer(g.vertex_array.name(), draw_record, records.buffer, records.offset, sizeof(GlDrawRecord));
  glBindVertexArray(g.vertex_array.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, positions_block, g.positions.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, normals_block, g.normals.name());
  if (g.attributes.uv) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, uv_block, g.uv.name());
  if (g.attributes.colours) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, colours_block, g.colours.name());
}

}  // namespace lodestone
