// The arrays of a cell's payload, listed once for all code that measures, writes, maps or compresses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Determines the lengths of a payload's arrays.
struct PayloadCounts {
  std::uint32_t vertices = 0, shared = 0, triangles = 0;
  bool has_parents = false;    // all cells but the root
  bool short_indices = false;  // parents and triangles have indices of 16 bits
  AttributeSet attributes;
};

[[nodiscard]] inline PayloadCounts counts_of(const Cell& cell) {
  const CellAttributes& a = cell.attributes;
  return {static_cast<std::uint32_t>(cell.positions.size()),
          static_cast<std::uint32_t>(cell.shared_ids.size()),
          static_cast<std::uint32_t>(cell.triangles.size()),
          cell.parent != no_cell,
          cell.triangles.is_short(),
          {false, !a.uv.empty(), !a.colours.empty(), !a.materials.empty()}};
}

// Calls visit(array, length) for the arrays of a cell (const or not) in file order: spans, or an IndexView, whose
// elements are short or not. A new line here adds an array to both forms of the file: its elements consist of 4-byte
// words (at most 256 bytes), and their type selects the codec of compressed payloads (lode_payload.cpp). Such a file
// needs a new bit of LodeFeatures. Short indices come last, where nothing has to be aligned after them.
template <class AnyCell, class Visit>
void visit_arrays(AnyCell& cell, const PayloadCounts& n, const Visit& visit) {
  const std::uint32_t parents = n.has_parents ? n.vertices : 0u;
  visit(cell.positions, n.vertices);
  visit(cell.normals, n.vertices);
  if (!n.short_indices) visit(cell.parents, parents);
  visit(cell.shared_ids, n.shared);
  visit(cell.attributes.uv, n.attributes.uv ? n.vertices : 0u);
  visit(cell.attributes.colours, n.attributes.colours ? n.vertices : 0u);
  visit(cell.attributes.materials, n.attributes.materials ? n.vertices : 0u);
  if (n.short_indices) visit(cell.parents, parents);
  visit(cell.triangles, n.triangles);
}
inline constexpr std::size_t payload_arrays = 8;

// Most vertices of cells with short indices.
inline constexpr std::uint32_t most_short = 1u << 16;

// Bytes of an array of so many elements as the in-memory Cell has them.
template <class T>
[[nodiscard]] std::uint64_t array_bytes(std::span<const T>, std::uint64_t length, bool /*short_indices*/) {
  return length * sizeof(T);
}
template <class T>
[[nodiscard]] std::uint64_t array_bytes(const IndexView<T>&, std::uint64_t length, bool short_indices) {
  return length * IndexView<T>::words * (short_indices ? sizeof(std::uint16_t) : sizeof(std::uint32_t));
}

// Bytes of all arrays, without padding.
[[nodiscard]] inline std::uint64_t plain_bytes(const PayloadCounts& n) {
  std::uint64_t bytes = 0;
  const Cell types;
  visit_arrays(types, n,
               [&](const auto& array, std::uint64_t length) { bytes += array_bytes(array, length, n.short_indices); });
  return bytes;
}

// The compressed form: one stream per array, by the codecs of meshoptimizer.
//
//   u32 bytes of each stream, in the order of visit_arrays | stream | stream | ...
//
// Positions are written as integers on the lattice of the whole model, so that a vertex gets the same bits in every
// cell; other per-vertex arrays are coded word by word; triangles by the index codec, which keeps their order and
// orientation but may begin each with another corner. Nothing else is lost. The size of the streams depends on the
// order of vertices and triangles (core/hierarchy/construct/cell_order.h).

// Appends the compressed payload, without padding. Throws InputError when a position is not on the lattice.
void compress_payload(const Cell& cell, Lattice lattice, std::vector<std::byte>& out);

// Writes the arrays to `out` as visit_arrays lists them, without padding, indices with 32 bits; out.size() ==
// plain_bytes(counts), counts without short indices. Returns
// the fault of the bytes, nullptr if there is none; never accesses memory outside the two spans. Indices may still be
// out of range: see payload_fault.
[[nodiscard]] const char* decompress_payload(std::span<const std::byte> bytes, const PayloadCounts& counts,
                                             Lattice lattice, std::span<std::byte> out);

// Maximum decompressed size of a payload of so many bytes: checked before memory is allocated.
[[nodiscard]] constexpr std::uint64_t max_decompressed(std::uint64_t bytes) { return 64 * bytes; }

// A *family*: the children of one cell, which are drawn together or not at all. It is named by its parent's index; the
// root alone is the family no_cell.
struct FamilyCells {
  CellId begin, end;
};

[[nodiscard]] inline FamilyCells family_cells(const Hierarchy& hierarchy, CellId parent) {
  if (parent == no_cell) return {CellId(0), CellId(1)};
  const Cell& cell = hierarchy.cells[parent];
  return {cell.first_child, cell.end_child()};
}

// Empties the arrays of the cell.
inline void drop_arrays(Cell& cell) {
  visit_arrays(cell, {}, [](auto& array, std::uint32_t) { array = {}; });
}

}  // namespace lodestone
