#include "parallel/distributed/cell_message.h"

#include <cstring>
#include <type_traits>

namespace lodestone {
namespace {

struct CellHead {
  CellCode code;
  CellFigures figures;
  std::uint32_t vertices = 0, shared = 0, triangles = 0, border_errors = 0;
};
static_assert(std::is_trivially_copyable_v<CellHead>);

// Calls visit(span) for the arrays of a cell, whose sizes are set.
template <class AnyCell, class Visit>
void visit_cell(AnyCell& cell, const Visit& visit) {
  visit(std::span(cell.slab.positions)), visit(std::span(cell.slab.normals)), visit(std::span(cell.slab.shared_ids));
  visit(std::span(cell.triangles)), visit(std::span(cell.border_errors)), visit(std::span(cell.ids));
  visit(std::span(cell.usage)), visit(std::span(cell.vertex_errors));
  visit(std::span(cell.vertex_ids)), visit(std::span(cell.slab.uv)), visit(std::span(cell.slab.colours));
  visit(std::span(cell.slab.materials));
}

}  // namespace

void append_cell(CellCode code, const CellBuild& cell, Message& message) {
  const auto append = [&](auto items) {
    const auto bytes = std::as_bytes(items);
    message.insert(message.end(), bytes.begin(), bytes.end());
  };
  CellHead head;
  std::memset(static_cast<void*>(&head), 0, sizeof(head));  // padding
  head.code = code;
  head.figures = cell;
  head.vertices = static_cast<std::uint32_t>(cell.vertex_count());
  head.shared = static_cast<std::uint32_t>(cell.slab.shared_ids.size());
  head.triangles = static_cast<std::uint32_t>(cell.triangles.size());
  head.border_errors = static_cast<std::uint32_t>(cell.border_errors.size());
  append(std::span(&head, 1));
  visit_cell(cell, append);
}

std::size_t cell_message_bytes(const CellCounts& counts) {
  const auto [wedges, uv, colours, materials] = counts.attributes;
  const std::size_t per_vertex = sizeof(Vec3f) + sizeof(PackedNormal) + sizeof(std::uint32_t) + sizeof(float) +
                                 (wedges ? sizeof(std::uint32_t) : 0) + (uv ? sizeof(Vec2f) : 0) +
                                 (colours ? sizeof(Rgba8) : 0) + (materials ? sizeof(std::uint32_t) : 0);
  constexpr std::size_t per_shared = sizeof(std::uint32_t) + sizeof(float) + sizeof(UsageBox);
  return sizeof(CellHead) + per_vertex * counts.vertices + per_shared * counts.shared +
         sizeof(Triangle) * counts.triangles;
}

template <class T>
void CellReader::take(std::span<T> to) {
  if (left_.size() < to.size_bytes()) throw Error("a message of cells ends too early");
  if (!to.empty()) std::memcpy(static_cast<void*>(to.data()), left_.data(), to.size_bytes());
  left_ = left_.subspan(to.size_bytes());
}

CellCode CellReader::read(CellBuild& cell) {
  CellHead head;
  take(std::span(&head, 1));
  static_cast<CellFigures&>(cell) = head.figures;
  cell.slab.allocate(head.vertices, head.shared, head.triangles, attributes_);
  cell.triangles = cell.slab.triangles;
  cell.border_errors.resize(head.border_errors);
  cell.ids.resize(head.vertices);
  cell.vertex_ids.resize(attributes_.wedges ? head.vertices : 0);
  cell.usage.resize(head.shared);
  cell.vertex_errors.resize(head.vertices);
  visit_cell(cell, [&](auto items) { take(items); });
  return head.code;
}

}  // namespace lodestone
