// The arrays of a cell's payload, listed once for everything that measures, writes, maps or compresses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// What the lengths of a payload's arrays follow from.
struct PayloadCounts {
  std::uint32_t vertices = 0, shared = 0, triangles = 0;
  bool has_parents = false;  // all cells but the root
  AttributeSet attributes;
};

[[nodiscard]] inline PayloadCounts counts_of(const Cell& cell) {
  const CellAttributes& a = cell.attributes;
  return {static_cast<std::uint32_t>(cell.positions.size()),
          static_cast<std::uint32_t>(cell.shared_ids.size()),
          static_cast<std::uint32_t>(cell.triangles.size()),
          cell.parent != no_cell,
          {false, !a.uv.empty(), !a.colours.empty(), !a.materials.empty()}};
}

// Calls visit(array, length) for the arrays of a cell (const or not) in file order. A line here adds an array to both
// forms of the file: its elements are made of 4-byte words (of at most 256 bytes), and the codec of compressed payloads
// is chosen by their type (lode_compress.cpp). Readers must be told by a new bit of LodeFeatures.
template <class AnyCell, class Visit>
void visit_arrays(AnyCell& cell, const PayloadCounts& n, const Visit& visit) {
  visit(cell.positions, n.vertices);
  visit(cell.normals, n.vertices);
  visit(cell.parents, n.has_parents ? n.vertices : 0u);
  visit(cell.shared_ids, n.shared);
  visit(cell.attributes.uv, n.attributes.uv ? n.vertices : 0u);
  visit(cell.attributes.colours, n.attributes.colours ? n.vertices : 0u);
  visit(cell.attributes.materials, n.attributes.materials ? n.vertices : 0u);
  visit(cell.triangles, n.triangles);
}
inline constexpr std::size_t payload_arrays = 8;

// Bytes of the arrays as the in-memory Cell has them, without padding.
[[nodiscard]] inline std::uint64_t plain_bytes(const PayloadCounts& n) {
  std::uint64_t bytes = 0;
  const Cell types;
  visit_arrays(types, n, [&](const auto& array, std::uint64_t length) { bytes += length * sizeof(*array.data()); });
  return bytes;
}

}  // namespace lodestone
