// Bytes of a .lode file -> Hierarchy. Everything is checked.
#include <bit>
#include <cstring>
#include <new>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/lode/lode_payload.h"
#include "core/hierarchy/model/structure.h"

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little, ".lode files are mapped in place: little-endian hosts only");

constexpr const char* rebuild = "build it again from the model";

[[noreturn]] void refuse(const std::string& file, const std::string& place, const std::string& what) {
  throw InputError(describe(file, place, what, rebuild));
}

void require(bool holds, const std::string& file, const char* place, const char* what) {
  if (!holds) refuse(file, place, what);
}

template <typename T>
T record_at(std::span<const std::byte> bytes, std::uint64_t offset) {
  T record;
  std::memcpy(&record, bytes.data() + offset, sizeof(T));
  return record;
}

// Checks size and kind first, so that nothing below reads beyond the end. The checksum follows, so that later checks
// only see files that a program wrote deliberately.
LodeHeader read_header(std::span<const std::byte> bytes, const std::string& file) {
  const auto say = [&](bool holds, const char* what) { require(holds, file, "header", what); };
  if (bytes.size() < lode_magic.size() || std::memcmp(bytes.data(), lode_magic.data(), lode_magic.size()) != 0)
    throw InputError(describe(file, "header", "not a .lode file", "give a file that `lodestone build` has written"));
  say(bytes.size() >= sizeof(LodeHeader), "the file ends inside the header");
  const auto h = record_at<LodeHeader>(bytes, 0);
  if (h.version > lode_version && h.byte_order == lode_byte_order)
    throw UnsupportedError(describe(file, "header", "version " + std::to_string(h.version) + " of the .lode format",
                                    "this program reads up to version " + std::to_string(lode_version)));
  say(h.byte_order == lode_byte_order && h.header_bytes == sizeof(LodeHeader) && h.level_bytes == sizeof(LodeLevel) &&
          h.cell_bytes == sizeof(LodeCell),
      "record sizes do not match the version");
  if ((h.features & ~lode_known_features) != 0)
    throw UnsupportedError(describe(file, "header", "features that this program does not know", "use a newer one"));
  say(h.lattice_bits <= Lattice::most_bits, "the lattice is out of range");
  say(h.features & lode_up ? (h.up & ~lode_guessed_up) <= static_cast<int>(UpAxis::earth) : h.up == 0,
      "the up axis is out of range");
  say(h.features & lode_named_simplifier ? (h.simplifier & 0xffff) == no_lode_simplifier
                                         : (h.simplifier & 0xffff) < lode_simplifiers.size(),
      "the simplifier is out of range");
  say(h.simplifier >> 16 <= 1, "the placement is out of range");
  say(!(h.features & lode_compressed) || h.lattice_bits != 0, "the file is compressed, but has no lattice");
  say(!(h.features & lode_compressed) || !(h.features & lode_short_indices), "compressed indices cannot be short");
  say(h.level_count >= 1 && h.level_count <= max_level + 1, "the number of levels is out of range");
  say(h.cell_count >= 1 && h.cell_count < no_cell, "the number of cells is out of range");
  const std::uint64_t tables = sizeof(LodeHeader) + h.level_count * sizeof(LodeLevel) + h.cell_count * sizeof(LodeCell);
  say(h.payload_offset == lode_aligned(tables), "the size of the tables is wrong");
  say(bytes.size() >= h.payload_offset, "the file ends inside the tables");
  const std::uint64_t rest = bytes.size() - h.payload_offset;
  say(rest >= h.payload_bytes && rest - h.payload_bytes >= h.asset_bytes, "the file is truncated");
  say(rest - h.payload_bytes == h.asset_bytes, "there are bytes after the end");
  return h;
}

void check_table_checksum(std::span<const std::byte> bytes, const LodeHeader& header, const std::string& file) {
  std::vector<std::byte> tables(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header.payload_offset));
  LodeHeader blank = header;
  blank.table_checksum = 0;
  std::memcpy(tables.data(), &blank, sizeof(blank));
  require(checksum(tables) == header.table_checksum, file, "tables",
          "the checksum does not match: the file was altered");
}

void take_header(Hierarchy& hierarchy, const LodeHeader& h) {
  hierarchy.transform = {{h.origin[0], h.origin[1], h.origin[2]}, h.scale, {h.lattice_bits}};
  if (h.features & lode_up)
    hierarchy.transform.up = {static_cast<UpAxis>(h.up & ~lode_guessed_up), (h.up & lode_guessed_up) != 0};
  hierarchy.sigma0 = h.sigma0;
  hierarchy.grids.halves = (h.features & lode_half_levels) != 0;
  const auto has = [&](LodeFeatures feature) { return (h.features & feature) != 0; };
  hierarchy.attributes = {
      .wedges = has(lode_wedges), .uv = has(lode_uv), .colours = has(lode_colours), .materials = has(lode_materials)};
  Provenance& p = hierarchy.provenance;
  p.input_vertices = h.input_vertices;
  p.input_triangles = h.input_triangles;
  p.repairs = {h.repairs[0], h.repairs[1], h.repairs[2], h.repairs[3], h.repairs[4],
               h.repairs[5], h.repairs[6], h.repairs[7], h.repairs[8]};
  p.fingerprint = h.fingerprint;
  if (!has(lode_named_simplifier)) p.simplifier = lode_simplifiers[h.simplifier & 0xffff];
  p.placement = h.simplifier >> 16;
  p.cell_triangles = h.cell_triangles;
  p.measured_errors = has(lode_measured_errors);
  p.refined = has(lode_refined);
}

void take_levels(Hierarchy& hierarchy, std::span<const std::byte> bytes, const LodeHeader& header,
                 const std::string& file) {
  std::uint64_t cells = 0;
  for (std::uint32_t l = 0; l < header.level_count; ++l) {
    const auto r = record_at<LodeLevel>(bytes, sizeof(LodeHeader) + l * sizeof(LodeLevel));
    cells += r.cell_count;
    hierarchy.levels.push_back({CellId(r.first_cell), r.cell_count, r.triangles, r.vertices, r.reach, r.diameter,
                                r.error, r.max_edge, r.long_edges});
  }
  require(cells == header.cell_count, file, "level table", "the levels do not cover the cells");
}

template <class T>
void place(std::span<const T>& items, const std::byte* at, std::size_t count, bool /*short_indices*/) {
  items = {reinterpret_cast<const T*>(at), count};
}
template <class T>
void place(IndexView<T>& items, const std::byte* at, std::size_t count, bool short_indices) {
  if (short_indices) {
    items = IndexView<T>(std::span(reinterpret_cast<const std::uint16_t*>(at), IndexView<T>::words * count));
  } else {
    items = std::span(reinterpret_cast<const T*>(at), count);
  }
}

// Views of a cell's arrays, one after the other from `at`.
void place_arrays(Cell& cell, const PayloadCounts& counts, const std::byte* at) {
  visit_arrays(cell, counts, [&](auto& items, std::size_t count) {
    place(items, at, count, counts.short_indices);
    at += array_bytes(items, count, counts.short_indices);
  });
}

Cell cell_of_record(const LodeCell& r, const PayloadCounts& counts, const std::byte* at) {
  Cell cell;
  cell.code = {r.code};
  cell.parent = CellId(r.parent);
  cell.first_child = CellId(r.first_child);
  cell.child_count = r.child_count;
  cell.bounds = {{r.lo[0], r.lo[1], r.lo[2]}, {r.hi[0], r.hi[1], r.hi[2]}};
  cell.max_displacement = r.max_displacement;
  cell.error = r.error;
  place_arrays(cell, counts, at);
  return cell;
}

std::string cell_place(CellId cell) { return "cell " + std::to_string(cell); }

// Memory for the plain payloads, not initialised.
std::shared_ptr<std::byte[]> allocate_payloads(std::uint64_t bytes, const std::string& file) {
  try {
    return std::shared_ptr<std::byte[]>(new std::byte[bytes]);
  } catch (const std::bad_alloc&) {
    throw ResourceError(describe(file, "", "there is no memory for " + std::to_string(bytes) + " bytes of payload"));
  }
}

}  // namespace

LodeReader::LodeReader(std::span<const std::byte> bytes, std::shared_ptr<const void> storage, std::string file)
    : bytes_(bytes), file_(std::move(file)) {
  const LodeHeader header = read_header(bytes, file_);
  check_table_checksum(bytes, header, file_);
  form_ = header.features & lode_compressed ? LodeForm::compressed : LodeForm::plain;
  take_header(hierarchy_, header);
  take_levels(hierarchy_, bytes, header, file_);
  take_cells(header, std::move(storage));
  if (const std::string fault = table_fault(hierarchy_); !fault.empty()) refuse(file_, "tables", fault);
  take_assets(header);
}

LodeCell LodeReader::record(CellId cell) const {
  const std::uint64_t table = sizeof(LodeHeader) + hierarchy_.levels.size() * sizeof(LodeLevel);
  return record_at<LodeCell>(bytes_, table + std::uint64_t{cell} * sizeof(LodeCell));
}

// Payloads are adjacent up to the assets; take_cells has checked it.
std::span<const std::byte> LodeReader::payload(CellId cell) const {
  const std::uint64_t begin = record(cell).offset;
  const std::uint64_t end = cell + 1 < cell_count() ? record(CellId(cell + 1)).offset : payload_end_;
  return bytes_.subspan(begin, end - begin);
}

void LodeReader::take_cells(const LodeHeader& header, std::shared_ptr<const void> storage) {
  const auto say = [&](bool holds, const char* what) { require(holds, file_, "cell table", what); };
  const auto counts = [&](const LodeCell& r, CellId c) {
    return PayloadCounts{r.vertices,
                         r.shared,
                         r.triangles,
                         c >= hierarchy_.levels.front().cell_count,
                         (header.features & lode_short_indices) != 0,
                         hierarchy_.attributes};
  };
  payload_end_ = header.payload_offset + header.payload_bytes;
  const auto count = static_cast<std::uint32_t>(header.cell_count);
  std::uint64_t unpacked = 0;
  for (CellId c{0}; c < count; ++c) {
    const LodeCell r = record(c);
    const std::uint64_t end = c + 1 < count ? record(CellId(c + 1)).offset : payload_end_;
    const std::uint64_t plain = plain_bytes(counts(r, c));
    say(r.offset >= header.payload_offset && r.offset <= end && end <= payload_end_ && r.offset % lode_alignment == 0 &&
            (c > 0 || r.offset == header.payload_offset),
        "a payload has a wrong offset");
    say(form_ == LodeForm::plain ? end - r.offset == lode_aligned(plain) : plain <= max_decompressed(end - r.offset),
        "the size of a payload does not match its counts");
    say(r.shared <= r.vertices, "a cell has more shared vertices than vertices");
    say(!(header.features & lode_short_indices) || r.vertices <= most_short,
        "a cell has too many vertices for short indices");
    unpacked += plain;
  }
  hierarchy_.storage = std::move(storage);
  if (form_ == LodeForm::compressed) {
    const std::shared_ptr<std::byte[]> memory = allocate_payloads(unpacked, file_);
    unpacked_ = memory.get();
    hierarchy_.storage = memory;
  }
  hierarchy_.cells.reserve(count);
  const std::byte* at = unpacked_;
  for (CellId c{0}; c < count; ++c) {
    const LodeCell r = record(c);
    const PayloadCounts n = counts(r, c);
    hierarchy_.cells.push_back(cell_of_record(r, n, form_ == LodeForm::plain ? bytes_.data() + r.offset : at));
    at += form_ == LodeForm::plain ? 0 : plain_bytes(n);
  }
}

void LodeReader::take_assets(const LodeHeader& header) {
  const std::span<const std::byte> assets = bytes_.subspan(payload_end_);
  const char* const place = "signatures, materials and textures";
  if (checksum(assets) != header.asset_checksum)
    refuse(file_, place, "the checksum does not match: the file was altered");
  if (const char* fault = decode_assets(assets, header.features, hierarchy_)) refuse(file_, place, fault);
}

void LodeReader::check(CellId first, CellId end) {
  for (CellId c = first; c < end; ++c) {
    const Cell& cell = hierarchy_.cells[c];
    std::span<std::byte> memory;
    if (form_ == LodeForm::compressed) {
      const auto at = reinterpret_cast<const std::byte*>(cell.positions.data()) - unpacked_;
      memory = {unpacked_ + at, plain_size(c)};
    }
    unpack(c, memory);
    if (const char* fault = payload_fault(hierarchy_, c)) refuse(file_, cell_place(c), fault);
  }
}

Cell LodeReader::load(CellId c, std::span<std::byte> memory) const {
  unpack(c, memory);
  if (form_ == LodeForm::plain) std::memcpy(memory.data(), payload(c).data(), memory.size());
  Cell cell = hierarchy_.cells[c];
  place_arrays(cell, counts_of(cell), memory.data());
  const std::size_t parent_vertices = cell.parent == no_cell ? 0 : hierarchy_.cells[cell.parent].positions.size();
  if (const char* fault = payload_fault(cell, hierarchy_.attributes, parent_vertices))
    refuse(file_, cell_place(c), fault);
  return cell;
}

std::uint64_t LodeReader::plain_size(CellId cell) const { return plain_bytes(counts_of(hierarchy_.cells[cell])); }

void LodeReader::unpack(CellId c, std::span<std::byte> memory) const {
  const std::span<const std::byte> packed = payload(c);
  if (checksum(packed) != record(c).checksum)
    refuse(file_, cell_place(c), "the checksum does not match: the file was altered");
  if (form_ == LodeForm::plain) return;
  const PayloadCounts n = counts_of(hierarchy_.cells[c]);
  if (const char* fault = decompress_payload(packed, n, hierarchy_.transform.lattice, memory))
    refuse(file_, cell_place(c), fault);
}

}  // namespace lodestone
