// Hierarchy -> bytes of a .lode file.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/lode/lode_payload.h"

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little, ".lode files are mapped in place: little-endian hosts only");

template <typename T>
std::byte* put(std::byte* to, std::span<const T> items) {
  if (!items.empty()) std::memcpy(to, items.data(), items.size_bytes());
  return to + items.size_bytes();
}

// Indices with 16 bits, as values that fit.
template <typename T>
std::byte* put_short(std::byte* to, const IndexView<T>& items) {
  if (items.is_short()) return put(to, items.short_indices());
  constexpr std::size_t words = IndexView<T>::words;
  const auto* from = reinterpret_cast<const std::uint32_t*>(items.wide().data());
  for (std::size_t i = 0; i < words * items.size(); ++i, to += sizeof(std::uint16_t)) {
    const auto index = static_cast<std::uint16_t>(from[i]);
    std::memcpy(to, &index, sizeof(index));
  }
  return to;
}

template <typename T>
std::byte* put(std::byte* to, const IndexView<T>& items, bool short_indices) {
  if (short_indices) return put_short(to, items);
  std::vector<T> room;
  return put(to, items.widened(room));
}
template <typename T>
std::byte* put(std::byte* to, std::span<const T> items, bool /*short_indices*/) {
  return put(to, items);
}

std::uint16_t features_of(const Hierarchy& hierarchy, const LodeLayout& layout) {
  const AttributeSet& a = hierarchy.attributes;
  const Provenance& p = hierarchy.provenance;
  return static_cast<std::uint16_t>(
      (layout.form == LodeForm::compressed ? lode_compressed : 0) | (layout.short_indices ? lode_short_indices : 0) |
      (a.wedges ? lode_wedges : 0) | (a.uv ? lode_uv : 0) | (a.colours ? lode_colours : 0) |
      (a.materials ? lode_materials : 0) | (p.measured_errors ? lode_measured_errors : 0) |
      (p.refined ? lode_refined : 0) | (hierarchy.texture_copies.empty() ? 0 : lode_texture_copies) |
      (has_surfaces(hierarchy) ? lode_surfaces : 0) | (has_named_simplifier(hierarchy) ? lode_named_simplifier : 0) |
      (hierarchy.transform.up == Up{} ? 0 : lode_up) | (hierarchy.grids.halves ? lode_half_levels : 0) |
      lode_signatures);
}

LodeHeader header_of(const Hierarchy& hierarchy, const LodeLayout& layout) {
  LodeHeader h;
  h.magic = lode_magic;
  h.features = features_of(hierarchy, layout);
  h.lattice_bits = static_cast<std::uint8_t>(hierarchy.transform.lattice.bits);
  if (const Up up = hierarchy.transform.up; up != Up{})
    h.up = static_cast<std::uint8_t>(static_cast<std::uint8_t>(up.axis) | (up.guessed ? lode_guessed_up : 0));
  h.version = lode_version;
  h.byte_order = lode_byte_order;
  h.header_bytes = sizeof(LodeHeader);
  h.level_bytes = sizeof(LodeLevel);
  h.cell_bytes = sizeof(LodeCell);
  h.level_count = static_cast<std::uint32_t>(hierarchy.levels.size());
  h.cell_count = hierarchy.cells.size();
  h.payload_offset = layout.table_bytes;
  h.payload_bytes = layout.payload_end() - layout.table_bytes;
  h.origin = {hierarchy.transform.origin.x, hierarchy.transform.origin.y, hierarchy.transform.origin.z};
  h.scale = hierarchy.transform.scale;
  h.sigma0 = hierarchy.sigma0;
  const Provenance& p = hierarchy.provenance;
  const auto simplifier = std::ranges::find(lode_simplifiers, p.simplifier);
  h.simplifier = simplifier == lode_simplifiers.end()
                     ? no_lode_simplifier
                     : static_cast<std::uint32_t>(simplifier - lode_simplifiers.begin());
  h.simplifier |= p.placement << 16;
  h.cell_triangles = p.cell_triangles;
  h.input_vertices = p.input_vertices;
  h.input_triangles = p.input_triangles;
  h.fingerprint = p.fingerprint;
  h.repairs = {p.repairs.polygons_triangulated, p.repairs.faces_dropped,        p.repairs.non_finite_triangles,
               p.repairs.welded_vertices,       p.repairs.degenerate_triangles, p.repairs.duplicate_triangles,
               p.repairs.unreferenced_vertices, p.repairs.void_posts,           p.repairs.filled_posts};
  return h;
}

LodeLevel record_of(const Level& level) {
  return {level.first_cell, level.cell_count, level.triangles, level.vertices, level.long_edges,
          level.reach,      level.diameter,   level.error,     level.max_edge, 0};
}

LodeCell record_of(const Cell& cell, const PayloadCounts& n, std::uint64_t offset, std::uint64_t checksum) {
  return {cell.code.morton,
          offset,
          checksum,
          cell.parent,
          cell.first_child,
          cell.child_count,
          n.vertices,
          n.shared,
          n.triangles,
          {cell.bounds.lo.x, cell.bounds.lo.y, cell.bounds.lo.z},
          {cell.bounds.hi.x, cell.bounds.hi.y, cell.bounds.hi.z},
          cell.max_displacement,
          cell.error};
}

template <class SizeOf>
LodeLayout plan(const Hierarchy& hierarchy, LodeLayout layout, const SizeOf& payload_size) {
  layout.table_bytes = lode_aligned(sizeof(LodeHeader) + hierarchy.levels.size() * sizeof(LodeLevel) +
                                    hierarchy.cells.size() * sizeof(LodeCell));
  layout.cell_offset.reserve(hierarchy.cells.size() + 1);
  std::uint64_t offset = layout.table_bytes;
  for (std::size_t c = 0; c < hierarchy.cells.size(); ++c) {
    layout.cell_offset.push_back(offset);
    offset += payload_size(c);
  }
  layout.cell_offset.push_back(offset);
  return layout;
}

std::vector<PayloadCounts> counts_of_cells(const Hierarchy& hierarchy) {
  std::vector<PayloadCounts> counts;
  counts.reserve(hierarchy.cells.size());
  for (const Cell& cell : hierarchy.cells) counts.push_back(counts_of(cell));
  return counts;
}

}  // namespace

LodeLayout plan_lode(const Hierarchy& hierarchy) { return plan_lode(hierarchy, counts_of_cells(hierarchy)); }

LodeLayout plan_lode(const Hierarchy& hierarchy, std::span<const PayloadCounts> counts) {
  LodeLayout layout;
  layout.short_indices = std::ranges::all_of(counts, [](const PayloadCounts& n) { return n.vertices <= most_short; });
  return plan(hierarchy, layout, [&](std::size_t c) {
    PayloadCounts n = counts[c];
    n.short_indices = layout.short_indices;
    return lode_aligned(plain_bytes(n));
  });
}

LodeLayout plan_compressed_lode(const Hierarchy& hierarchy, std::span<const std::uint64_t> payload_sizes) {
  return plan(hierarchy, {.form = LodeForm::compressed, .cell_offset = {}},
              [&](std::size_t c) { return payload_sizes[c]; });
}

std::vector<LodeChunk> lode_chunks(const LodeLayout& layout, std::uint64_t chunk_bytes) {
  std::vector<LodeChunk> chunks;
  const auto cells = static_cast<std::uint32_t>(layout.cell_offset.size() - 1);
  for (CellId first, end; first < cells; first = end) {
    while (end < cells && (end == first || layout.cell_offset[end + 1] - layout.cell_offset[first] <= chunk_bytes))
      ++end;
    chunks.push_back({first, end});
  }
  return chunks;
}

std::uint64_t encode_payload(const Cell& cell, bool short_indices, std::span<std::byte> bytes) {
  assert(cell.normals.size() == cell.positions.size());
  assert(cell.parents.size() == (cell.parent == no_cell ? 0 : cell.positions.size()));
  std::byte* to = bytes.data();
  PayloadCounts counts = counts_of(cell);
  counts.short_indices = short_indices;
  visit_arrays(cell, counts, [&](const auto& items, std::size_t) { to = put(to, items, short_indices); });
  std::fill(to, bytes.data() + bytes.size(), std::byte{0});
  return checksum(bytes);
}

std::uint64_t append_compressed_payload(const Cell& cell, Lattice lattice, std::vector<std::byte>& bytes) {
  const std::size_t begin = bytes.size();
  compress_payload(cell, lattice, bytes);
  bytes.resize(begin + lode_aligned(bytes.size() - begin));
  return checksum(std::span(bytes).subspan(begin));
}

void encode_lode_chunk(const Hierarchy& hierarchy, const LodeLayout& layout, LodeChunk chunk,
                       std::vector<std::byte>& bytes, std::span<std::uint64_t> checksums) {
  const std::uint64_t start = layout.cell_offset[chunk.first_cell];
  bytes.resize(layout.cell_offset[chunk.end_cell] - start);
  for (CellId c = chunk.first_cell; c < chunk.end_cell; ++c)
    checksums[c] = encode_payload(
        hierarchy.cells[c], layout.short_indices,
        std::span(bytes).subspan(layout.cell_offset[c] - start, layout.cell_offset[c + 1] - layout.cell_offset[c]));
}

void compress_lode_chunk(const Hierarchy& hierarchy, LodeChunk chunk, std::vector<std::byte>& bytes,
                         std::span<std::uint64_t> payload_sizes, std::span<std::uint64_t> checksums) {
  const Lattice lattice = hierarchy.transform.lattice;
  if (!lattice)
    throw InputError(describe("", "", "only a hierarchy on a lattice can be compressed", "build it with --lattice"));
  bytes.clear();
  for (CellId c = chunk.first_cell; c < chunk.end_cell; ++c) {
    const std::size_t begin = bytes.size();
    checksums[c] = append_compressed_payload(hierarchy.cells[c], lattice, bytes);
    payload_sizes[c] = bytes.size() - begin;
  }
}

std::vector<std::byte> encode_lode_tables(const Hierarchy& hierarchy, const LodeLayout& layout,
                                          std::span<const std::uint64_t> checksums, std::span<const std::byte> assets) {
  return encode_lode_tables(hierarchy, counts_of_cells(hierarchy), layout, checksums, assets);
}

std::vector<std::byte> encode_lode_tables(const Hierarchy& hierarchy, std::span<const PayloadCounts> counts,
                                          const LodeLayout& layout, std::span<const std::uint64_t> checksums,
                                          std::span<const std::byte> assets) {
  std::vector<std::byte> bytes(layout.table_bytes);
  LodeHeader header = header_of(hierarchy, layout);
  header.asset_bytes = assets.size();
  header.asset_checksum = checksum(assets);
  std::byte* to = bytes.data() + sizeof(LodeHeader);
  for (const Level& level : hierarchy.levels) {
    const LodeLevel record = record_of(level);
    to = put(to, std::span(&record, 1));
  }
  for (std::size_t c = 0; c < hierarchy.cells.size(); ++c) {
    const LodeCell record = record_of(hierarchy.cells[c], counts[c], layout.cell_offset[c], checksums[c]);
    to = put(to, std::span(&record, 1));
  }
  std::memcpy(bytes.data(), &header, sizeof(header));
  header.table_checksum = checksum(bytes);
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

}  // namespace lodestone
