#include "parallel/out_of_core/cell_store.h"

namespace lodestone {
namespace {

template <class T>
std::span<const std::byte> const_bytes(const std::span<T>& items) {
  return std::as_bytes(items);
}
template <class T>
std::span<const std::byte> const_bytes(const std::vector<T>& items) {
  return std::as_bytes(std::span(items));
}
template <class T>
std::span<std::byte> writable_bytes(std::span<T> items) {
  return std::as_writable_bytes(items);
}
template <class T>
std::span<std::byte> writable_bytes(std::vector<T>& items) {
  return std::as_writable_bytes(std::span(items));
}

}  // namespace

PayloadCounts counts_of(const StoredCell& cell, bool has_parents, const AttributeSet& attributes) {
  AttributeSet stored = attributes;
  stored.wedges = false;
  return {cell.vertices, cell.shared, cell.triangles, has_parents, false, stored};
}

template <class AnyCell, class Visit>
void CellStore::visit_body(AnyCell& cell, bool for_block, const Visit& visit) const {
  visit(cell.slab.positions), visit(cell.slab.normals), visit(cell.slab.shared_ids);
  visit(cell.slab.uv), visit(cell.slab.colours), visit(cell.slab.materials);
  visit(cell.triangles), visit(cell.border_errors);
  if (!for_block) return;
  visit(cell.ids), visit(cell.vertex_ids), visit(cell.usage), visit(cell.vertex_errors);
}

std::uint64_t CellStore::body_bytes(const StoredCell& cell, bool for_block) const {
  const std::uint64_t payload = plain_bytes(counts_of(cell, false, attributes_)) + cell.border_errors * sizeof(float);
  if (!for_block) return payload;
  const std::uint64_t words = attributes_.wedges ? 3 : 2;
  return payload + words * cell.vertices * sizeof(std::uint32_t) + cell.shared * sizeof(UsageBox);
}

void CellStore::put(const CellBuild& cell, bool for_block, StoredCell& stored) {
  static_cast<CellFigures&>(stored) = cell;
  stored.vertices = static_cast<std::uint32_t>(cell.vertex_count());
  stored.shared = static_cast<std::uint32_t>(cell.slab.shared_ids.size());
  stored.triangles = static_cast<std::uint32_t>(cell.triangles.size());
  stored.border_errors = static_cast<std::uint32_t>(cell.border_errors.size());
  std::uint64_t at = stored.body = file_.claim(body_bytes(stored, for_block));
  visit_body(cell, for_block, [&](const auto& array) {
    const std::span<const std::byte> bytes = const_bytes(array);
    file_.write_at(at, bytes);
    at += bytes.size();
  });
}

void CellStore::put_parents(const CellBuild& cell, StoredCell& stored) {
  static_cast<CellFigures&>(stored) = cell;
  const std::span<const std::byte> bytes = const_bytes(cell.slab.parents);
  stored.parents = file_.claim(bytes.size());
  file_.write_at(stored.parents, bytes);
}

void CellStore::get(const StoredCell& stored, bool for_block, CellBuild& cell) const {
  static_cast<CellFigures&>(cell) = stored;
  cell.slab.allocate(stored.vertices, stored.shared, stored.triangles, attributes_);
  cell.triangles = cell.slab.triangles;
  cell.border_errors.resize(stored.border_errors);
  if (for_block) {
    cell.ids.resize(stored.vertices);
    if (attributes_.wedges) cell.vertex_ids.resize(stored.vertices);
    cell.usage.resize(stored.shared);
    cell.vertex_errors.resize(stored.vertices);
  }
  std::uint64_t at = stored.body;
  visit_body(cell, for_block, [&](auto& array) {
    const std::span<std::byte> bytes = writable_bytes(array);
    file_.read_at(at, bytes);
    at += bytes.size();
  });
}

void CellStore::get_border(const StoredCell& stored, std::vector<Vec3f>& positions, std::vector<float>& errors) const {
  positions.resize(stored.shared), errors.resize(stored.border_errors);
  file_.read_at(stored.body + (stored.vertices - stored.shared) * sizeof(Vec3f), writable_bytes(positions));
  const std::uint64_t payload = plain_bytes(counts_of(stored, false, attributes_));
  file_.read_at(stored.body + payload, writable_bytes(errors));
}

void CellStore::get_for_block(const StoredCell& stored, CellBuild& cell) const { get(stored, true, cell); }

void CellStore::get_payload(const StoredCell& stored, bool has_parents, CellBuild& cell) const {
  get(stored, false, cell);
  if (has_parents) file_.read_at(stored.parents, std::as_writable_bytes(cell.slab.parents));
}

}  // namespace lodestone
