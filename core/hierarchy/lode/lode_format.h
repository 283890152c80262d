// The bytes of a .lode file: records, offsets, and the kernels that turn cells into bytes and back.
//
// Layout, little-endian, everything 16-byte aligned:
//
//   LodeHeader | LodeLevel x levels | LodeCell x cells | padding | payload of cell 0 | payload of cell 1 | ... | assets
//
// Cells go from coarse to fine, so that a reader (or a network) gets a whole coarse model first. A plain payload holds
// the arrays as the in-memory Cell has them (visit_arrays), then zeros up to 16 bytes: a
// mapped file is used in place, and all offsets follow from the counts alone. A compressed payload holds the same
// arrays as streams (core/hierarchy/lode/lode_payload.h), then zeros up to 16 bytes. Payloads follow each other, so
// that each ends where the next begins. Assets are signatures, materials and textures with their copies
// (encode_assets), before them the name of a simplifier that is not ours. Each payload has its XXH3-64 checksum in the
// cell table; one more covers header and tables, and one the assets. Nothing in the file depends on time, paths or
// threads: equal hierarchies give equal bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/lode/lode_payload.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/model/signatures.h"

namespace lodestone {

// The first byte is not ASCII and the line ends differ, so that a transfer in text mode is detected (as in PNG).
inline constexpr std::array<char, 8> lode_magic{'\x93', 'L', 'O', 'D', 'E', '\r', '\n', '\x1a'};
inline constexpr std::uint32_t lode_version = 1;
inline constexpr std::uint32_t lode_byte_order = 0x0403'0201u;
inline constexpr std::uint64_t lode_alignment = 16;
[[nodiscard]] constexpr std::uint64_t lode_aligned(std::uint64_t n) {
  return (n + lode_alignment - 1) / lode_alignment * lode_alignment;
}

// Bits of LodeHeader::features. A reader refuses a file with a bit that it does not know.
enum LodeFeatures : std::uint16_t {
  lode_compressed = 1,
  lode_wedges = 2,  // AttributeSet::wedges, and so on
  lode_uv = 4,
  lode_colours = 8,
  lode_materials = 16,
  lode_measured_errors = 32,     // Provenance::measured_errors
  lode_refined = 64,             // Provenance::refined
  lode_texture_copies = 128,     // Hierarchy::texture_copies
  lode_surfaces = 256,           // the assets have an object of surfaces
  lode_up = 512,                 // the header says which axis is up; without it z is, as a guess
  lode_named_simplifier = 1024,  // the assets begin with its name
  lode_signatures = 2048,        // the assets have signatures; files of older programs have none
  lode_short_indices = 4096,     // PayloadCounts::short_indices: plain files whose cells have at most 65,536 vertices
  lode_half_levels = 8192,       // LevelGrids::halves
  lode_known_features = 16383,
};

inline constexpr std::uint8_t lode_guessed_up = 128;
inline constexpr std::array<std::string_view, 4> lode_simplifiers{"quadric", "cluster", "openmesh", "meshopt"};
inline constexpr std::uint32_t no_lode_simplifier = 0xffff;

struct LodeHeader {
  std::array<char, 8> magic{};
  std::uint32_t version = 0, byte_order = 0;
  std::uint32_t header_bytes = 0, level_bytes = 0, cell_bytes = 0;  // sizes of the three records
  std::uint32_t level_count = 0;
  std::uint64_t cell_count = 0;
  std::uint64_t payload_offset = 0, payload_bytes = 0, asset_bytes = 0;  // their sum is the file size
  std::uint64_t table_checksum = 0;                                      // of header and tables, with this field 0
  std::uint64_t asset_checksum = 0;
  std::array<double, 3> origin{};
  double scale = 0;
  float sigma0 = 0;
  // Which of lode_simplifiers in the lower half, or no_lode_simplifier with lode_named_simplifier; Placement in the
  // upper one.
  std::uint32_t simplifier = 0;
  std::uint32_t cell_triangles = 0;
  std::uint16_t features = 0;  // LodeFeatures
  std::uint8_t lattice_bits = 0;
  std::uint8_t up = 0;  // UpAxis, plus lode_guessed_up; 0 without the feature
  std::uint64_t input_vertices = 0, input_triangles = 0, fingerprint = 0;
  std::array<std::uint64_t, 9> repairs{};  // in the order of struct Repairs
};
static_assert(sizeof(LodeHeader) == 8 + 6 * 4 + 6 * 8 + 4 * 8 + 4 * 4 + 3 * 8 + 9 * 8);  // no padding

struct LodeLevel {
  std::uint32_t first_cell = 0, cell_count = 0;
  std::uint64_t triangles = 0, vertices = 0, long_edges = 0;
  std::array<float, distance_metric_count> reach{};
  float diameter = 0, error = 0, max_edge = 0;
  std::uint32_t reserved = 0;
};
static_assert(sizeof(LodeLevel) == 2 * 4 + 3 * 8 + 2 * 4 + 3 * 4 + 4);

struct LodeCell {
  std::uint64_t code = 0;
  std::uint64_t offset = 0;    // of the payload, from the start of the file
  std::uint64_t checksum = 0;  // of the payload with its padding, as stored in the file
  std::uint32_t parent = 0, first_child = 0, child_count = 0;
  std::uint32_t vertices = 0, shared = 0, triangles = 0;
  std::array<float, 3> lo{}, hi{};
  float max_displacement = 0, error = 0;
};
static_assert(sizeof(LodeCell) == 3 * 8 + 6 * 4 + 6 * 4 + 2 * 4);

// Offsets in the file.
struct LodeLayout {
  LodeForm form = LodeForm::plain;
  bool short_indices = false;              // plain, and no cell has more than most_short vertices
  std::uint64_t table_bytes = 0;           // header, levels, cells and padding: the offset of the first payload
  std::vector<std::uint64_t> cell_offset;  // one per cell, and one more for the assets
  [[nodiscard]] std::uint64_t payload_end() const { return cell_offset.back(); }
};
[[nodiscard]] LodeLayout plan_lode(const Hierarchy& hierarchy);
// The same for cells whose payloads are stored elsewhere: their counts, one per cell.
[[nodiscard]] LodeLayout plan_lode(const Hierarchy& hierarchy, std::span<const PayloadCounts> counts);
// The same for compressed payloads, whose sizes are known after compression: one per cell, multiples of 16.
[[nodiscard]] LodeLayout plan_compressed_lode(const Hierarchy& hierarchy, std::span<const std::uint64_t> payload_sizes);

// Writes the plain payload of one cell, with padding, into the bytes that the layout has for it. Returns its checksum.
std::uint64_t encode_payload(const Cell& cell, bool short_indices, std::span<std::byte> bytes);
// Appends the compressed payload with padding. Returns its checksum. Throws InputError when a vertex is off the
// lattice.
std::uint64_t append_compressed_payload(const Cell& cell, Lattice lattice, std::vector<std::byte>& bytes);

// A run of consecutive cells that is encoded and written at once.
struct LodeChunk {
  CellId first_cell, end_cell;
};
// Cuts all cells into runs of about chunk_bytes, each at least one cell; a function of the layout alone.
[[nodiscard]] std::vector<LodeChunk> lode_chunks(const LodeLayout& layout, std::uint64_t chunk_bytes = 4u << 20);

// Writes the chunk's plain payloads into `bytes` (resized), their checksums into checksums[first_cell..end_cell).
void encode_lode_chunk(const Hierarchy& hierarchy, const LodeLayout& layout, LodeChunk chunk,
                       std::vector<std::byte>& bytes, std::span<std::uint64_t> checksums);

// The same for compressed payloads, one after the other; their sizes into payload_sizes[first_cell..end_cell). Throws
// InputError when the hierarchy has no lattice.
void compress_lode_chunk(const Hierarchy& hierarchy, LodeChunk chunk, std::vector<std::byte>& bytes,
                         std::span<std::uint64_t> payload_sizes, std::span<std::uint64_t> checksums);

// Header and tables: the first layout.table_bytes bytes of the file. checksums: one per cell.
// assets: the bytes after the last payload (encode_assets).
[[nodiscard]] std::vector<std::byte> encode_lode_tables(const Hierarchy& hierarchy, const LodeLayout& layout,
                                                        std::span<const std::uint64_t> checksums,
                                                        std::span<const std::byte> assets = {});
// The same for cells whose payloads are stored elsewhere.
[[nodiscard]] std::vector<std::byte> encode_lode_tables(const Hierarchy& hierarchy,
                                                        std::span<const PayloadCounts> counts, const LodeLayout& layout,
                                                        std::span<const std::uint64_t> checksums,
                                                        std::span<const std::byte> assets);

// The last section of the file:
//
//   [string simplifier |] u64 bytes | signatures
//   signatures: u32 sets x levels | u32 cells x sets | u32 cell x cells of all sets | f32 error x sets |
//   u8 place x shared vertices
//   (Signatures::Table); only in files with the feature lode_signatures, which all have that are written
//
// and then, if there are any, materials and textures:
//
//   u32 materials | material x n | u32 textures | texture x n [| u32 copies | copy x n] [| u64 bytes | surfaces]
//   material: string name, 4 floats of base colour, u32 texture, u32 normal map
//   texture: string name, string media type, u8 wrap in u and v, u16 zero, u64 bytes, the bytes
//   copy of a texture: u32 texture, u32 halvings, u32 width and height, u64 bytes, the bytes; by texture, then 1, 2,
//   ... halvings; only in files with the feature lode_texture_copies
//   string: u32 bytes, the bytes
//   surfaces: what materials and textures say beyond these records, in JSON: {"materials": one object for each, as in
//   glTF (core/formats/gltf/gltf_surface.h), "samplers": one for each texture}; only in files with the feature
//   lode_surfaces, which those have whose materials or textures differ from the defaults of Material and Texture
//
// Without signatures: those of files of older programs.
[[nodiscard]] std::vector<std::byte> encode_assets(const Hierarchy& hierarchy,
                                                   const Signatures::Table* signatures = nullptr);
// True if the assets of the hierarchy begin with the name of a simplifier.
[[nodiscard]] bool has_named_simplifier(const Hierarchy& hierarchy);
// True if the assets of the hierarchy have an object of surfaces.
[[nodiscard]] bool has_surfaces(const Hierarchy& hierarchy);
// Returns the fault of the bytes, nullptr if there is none. Of the features those that concern assets count, and of the
// hierarchy the tables of levels and cells.
[[nodiscard]] const char* decode_assets(std::span<const std::byte> bytes, std::uint16_t features, Hierarchy& hierarchy);

// A file that is being opened: its tables as a hierarchy. Payloads are views of `bytes`, or of memory that check()
// decompresses into, as large as the plain payloads. `bytes` starts 16-byte aligned and lives as long as `storage`.
class LodeReader {
 public:
  // Checks header and tables in full (sizes, checksum, ranges, order, finite values), the payloads only for lying
  // inside `bytes`. Throws InputError for a foreign, truncated or altered file, UnsupportedError for a newer version or
  // an unknown feature, ResourceError when there is no memory to decompress into; `file` names it.
  LodeReader(std::span<const std::byte> bytes, std::shared_ptr<const void> storage, std::string file);

  // Checks the payloads of cells [first, end), having decompressed them: checksum, finite positions, every index in
  // range, no degenerate triangle. Throws InputError. May be called at once for disjoint ranges.
  void check(CellId first, CellId end);

  // One cell alone: what check() does, but the arrays of the cell returned lie in `memory`, of plain_size(cell) bytes
  // and 16-byte aligned. Any number of threads may load at once.
  [[nodiscard]] Cell load(CellId cell, std::span<std::byte> memory) const;
  [[nodiscard]] std::uint64_t plain_size(CellId cell) const;
  [[nodiscard]] std::span<const std::byte> payload(CellId cell) const;  // as stored in the file

  // The tables: cells as the file has them. Their arrays must not be used before they are checked.
  [[nodiscard]] const Hierarchy& tables() const { return hierarchy_; }
  [[nodiscard]] std::uint32_t cell_count() const { return static_cast<std::uint32_t>(hierarchy_.cells.size()); }
  // The hierarchy, after all cells are checked.
  [[nodiscard]] Hierarchy take() && { return std::move(hierarchy_); }

 private:
  void take_cells(const LodeHeader& header, std::shared_ptr<const void> storage);
  void take_assets(const LodeHeader& header);
  [[nodiscard]] LodeCell record(CellId cell) const;
  // Checks the checksum and, in the compressed form, decompresses into `memory`.
  void unpack(CellId cell, std::span<std::byte> memory) const;

  std::span<const std::byte> bytes_;
  std::string file_;
  Hierarchy hierarchy_;
  std::uint64_t payload_end_ = 0;
  LodeForm form_ = LodeForm::plain;
  std::byte* unpacked_ = nullptr;  // compressed form: the plain payloads, one after the other
};

}  // namespace lodestone
