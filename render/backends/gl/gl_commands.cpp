#include "render/backends/gl/gl_commands.h"

#include <cassert>

namespace lodestone {
namespace {

// The selection calls a cell static when lambda = 1 on its whole box by the CPU's distances. The shader's square root
// may be a few units in the last place off, and a vertex that it shares with a morphing cell must not move there: a
// cell is static here only with some room to the band.
bool is_static(const Frame& frame, const SelectedCell& selected) {
  if (selected.level == 0) return true;
  if (selected.morphing) return false;
  const Radii& radii = *frame.morph.radii;
  const Box3f& bounds = frame.morph.hierarchy->cells[selected.cell].bounds;
  return limited_farthest_distance(radii.metric, frame.morph.viewpoint, bounds, frame.morph.limits) *
             (1 + rounding_guard) <
         radii.band_begin[selected.level];
}

// New storage every time: the driver gives the old one back when no draw reads it any more.
template <class T>
void replace(const GlBuffer& buffer, const std::vector<T>& values) {
  glNamedBufferData(buffer.name(), static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), GL_STREAM_DRAW);
}

}  // namespace

void GlCommands::set(const Frame& frame, const GlScene& scene) {
  commands_.clear();
  records_.clear();
  multi_draws_.clear();
  limits_.clear();
  cells_ = triangles_ = 0;
  for (const SelectedCell& selected : frame.selection->cells)
    if (selected.visible) add(frame, scene, selected);
  replace(command_buffer_, commands_);
  replace(record_buffer_, records_);
  if (limits_.empty()) limits_.emplace_back();  // no empty blocks in OpenGL
  replace(limit_buffer_, limits_);
}

void GlCommands::add(const Frame& frame, const GlScene& scene, const SelectedCell& selected) {
  const Cell& cell = scene.hierarchy().cells[selected.cell];
  const CellPlace& place = scene.place(selected.cell);
  ++cells_;
  if (cell.triangles.empty()) return;
  triangles_ += cell.triangles.size();

  const auto number = static_cast<std::uint32_t>(commands_.size());
  // A selection comes in depth-first order, as the groups are: each is one run.
  if (multi_draws_.empty() || multi_draws_.back().group != place.group)
    multi_draws_.push_back({place.group, number, 0});
  ++multi_draws_.back().command_count;
  commands_.push_back({static_cast<std::uint32_t>(3 * cell.triangles.size()), 1, place.first_index,
                       static_cast<std::int32_t>(place.first_vertex), number});
  GlDrawRecord record{place.parent_first_vertex, selected.level, 0, 0};
  if (!is_static(frame, selected)) {
    record.level += morphs_bit;
    record.first_limit = static_cast<std::uint32_t>(limits_.size());
    near_.clear();
    limits_near(frame.morph.radii->metric, frame.morph.viewpoint, cell.bounds, frame.morph.limits, near_);
    for (const DetailLimit& l : near_)
      limits_.push_back({{l.box.lo.x, l.box.lo.y, l.box.lo.z}, l.radius, {l.box.hi.x, l.box.hi.y, l.box.hi.z}, 0});
    record.end_limit = static_cast<std::uint32_t>(limits_.size());
  }
  records_.push_back(record);
}

void GlCommands::draw(const GlScene& scene) const {
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, command_buffer_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, limits_block, limit_buffer_.name());
  for (const GlMultiDraw& multi : multi_draws_) {
    scene.bind(multi.group, record_buffer_);
    const std::uintptr_t offset = std::uintptr_t{multi.first_command} * sizeof(GlDrawCommand);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset),
                                static_cast<GLsizei>(multi.command_count), 0);
  }
}

}  // namespace lodestone
