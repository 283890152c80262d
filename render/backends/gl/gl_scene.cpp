#include "render/backends/gl/gl_scene.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <functional>
#include <span>

#include "render/backends/gl/gl_device.h"
#include "render/backends/gl/gl_shaders.h"

namespace lodestone {
namespace {

// The shader computes 3 * vertex in 32 bits, and base vertices are signed.
constexpr std::uint64_t addressable_vertices = 0x7fff'ffffu / 3;

// Appends spans to mapped memory.
class Writer {
 public:
  explicit Writer(std::byte* to) : to_(to) {}
  template <class T>
  void append(std::span<const T> values) {
    if (values.empty()) return;
    std::memcpy(to_, values.data(), values.size_bytes());
    to_ += values.size_bytes();
  }
  void skip(std::size_t bytes) { to_ += bytes; }

 private:
  std::byte* to_;
};

// Immutable storage, filled once through a mapping: no staging copy on our side.
GlBuffer filled_buffer(std::uint64_t bytes, const std::function<void(Writer)>& fill) {
  GlBuffer buffer;
  const auto size = static_cast<GLsizeiptr>(std::max<std::uint64_t>(bytes, 4));  // no empty buffers in OpenGL
  glNamedBufferStorage(buffer.name(), size, nullptr, GL_MAP_WRITE_BIT);
  check_memory("uploading the hierarchy");
  void* mapped = glMapNamedBufferRange(buffer.name(), 0, size, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  check_memory("uploading the hierarchy");
  assert(mapped);
  fill(Writer(static_cast<std::byte*>(mapped)));
  glUnmapNamedBuffer(buffer.name());
  return buffer;
}

void set_attribute(GLuint array, GLuint attribute, GLint count, GLenum type) {
  glEnableVertexArrayAttrib(array, attribute);
  glVertexArrayAttribBinding(array, attribute, attribute);
  if (type == GL_FLOAT)
    glVertexArrayAttribFormat(array, attribute, count, type, GL_FALSE, 0);
  else
    glVertexArrayAttribIFormat(array, attribute, count, type, 0);
}

}  // namespace

GlScene::GlScene(const Hierarchy& hierarchy, std::size_t max_storage_block_bytes) : hierarchy_(hierarchy) {
  CellGroups plan =
      plan_groups(hierarchy, std::min<std::uint64_t>(max_storage_block_bytes / sizeof(Vec3f), addressable_vertices));
  places_ = std::move(plan.places);
  groups_.reserve(plan.groups.size());
  for (const CellGroup& group : plan.groups) groups_.push_back(upload(group));
}

GlScene::Group GlScene::upload(const CellGroup& group) const {
  const auto cells = [&](const auto& visit) {
    for (const std::uint32_t cell : group.cells) visit(hierarchy_.cells[cell]);
  };
  const auto cells_and_halo = [&](const auto& visit) {
    cells(visit);
    for (const std::uint32_t cell : group.halo) visit(hierarchy_.cells[cell]);
  };
  // The halo is not drawn, and the root has no parents: their slots in the buffer of parents stay unread.
  Group made{filled_buffer(group.vertices * sizeof(Vec3f),
                           [&](Writer to) { cells_and_halo([&](const Cell& c) { to.append(c.positions); }); }),
             filled_buffer(group.vertices * sizeof(PackedNormal),
                           [&](Writer to) { cells_and_halo([&](const Cell& c) { to.append(c.normals); }); }),
             filled_buffer(group.vertices * sizeof(std::uint32_t),
                           [&](Writer to) {
                             cells([&](const Cell& c) {
                               to.append(c.parents);
                               if (c.parents.empty()) to.skip(c.positions.size() * sizeof(std::uint32_t));
                             });
                           }),
             filled_buffer(group.indices * sizeof(std::uint32_t),
                           [&](Writer to) { cells([&](const Cell& c) { to.append(c.triangles); }); }),
             GlVertexArray()};

  const GLuint array = made.vertex_array.name();
  set_attribute(array, own_position, 3, GL_FLOAT);
  set_attribute(array, own_normal, 2, GL_SHORT);
  set_attribute(array, parent_index, 1, GL_UNSIGNED_INT);
  set_attribute(array, draw_record, 3, GL_UNSIGNED_INT);
  glVertexArrayVertexBuffer(array, own_position, made.positions.name(), 0, sizeof(Vec3f));
  glVertexArrayVertexBuffer(array, own_normal, made.normals.name(), 0, sizeof(PackedNormal));
  glVertexArrayVertexBuffer(array, parent_index, made.parents.name(), 0, sizeof(std::uint32_t));
  glVertexArrayBindingDivisor(array, draw_record, 1);
  glVertexArrayElementBuffer(array, made.indices.name());
  return made;
}

void GlScene::bind(std::uint32_t group, const GlBuffer& records) const {
  const Group& g = groups_[group];
  glVertexArrayVertexBuffer(g.vertex_array.name(), draw_record, records.name(), 0, sizeof(GlDrawRecord));
  glBindVertexArray(g.vertex_array.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, positions_block, g.positions.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, normals_block, g.normals.name());
}

}  // namespace lodestone
