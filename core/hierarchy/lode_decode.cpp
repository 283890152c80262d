// Bytes of a .lode file -> Hierarchy, trusting nothing.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>
#include <cstring>

#include "core/base/error.h"
#include "core/hierarchy/lode_format.h"
#include "core/hierarchy/structure.h"

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

// Size and kind first, so that nothing below reads beyond the end; the checksum next, so that what follows only meets
// files that a program wrote on purpose.
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
      "record sizes do not fit the version");
  say(h.level_count >= 1 && h.level_count <= max_level + 1, "number of levels out of range");
  say(h.cell_count >= 1 && h.cell_count < no_cell, "number of cells out of range");
  const std::uint64_t tables = sizeof(LodeHeader) + h.level_count * sizeof(LodeLevel) + h.cell_count * sizeof(LodeCell);
  say(h.payload_offset == (tables + lode_alignment - 1) / lode_alignment * lode_alignment, "wrong size of the tables");
  say(bytes.size() >= h.payload_offset, "the file ends inside the tables");
  say(bytes.size() - h.payload_offset >= h.payload_bytes, "the file is truncated");
  say(bytes.size() - h.payload_offset == h.payload_bytes, "the file goes on beyond its end");
  return h;
}

void check_table_checksum(std::span<const std::byte> bytes, const LodeHeader& header, const std::string& file) {
  std::vector<std::byte> tables(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header.payload_offset));
  LodeHeader blank = header;
  blank.table_checksum = 0;
  std::memcpy(tables.data(), &blank, sizeof(blank));
  require(XXH3_64bits(tables.data(), tables.size()) == header.table_checksum, file, "tables",
          "the checksum does not fit: the file was altered");
}

void take_header(Hierarchy& hierarchy, const LodeHeader& h) {
  hierarchy.transform = {{h.origin[0], h.origin[1], h.origin[2]}, h.scale};
  hierarchy.sigma0 = h.sigma0;
  Provenance& p = hierarchy.provenance;
  p.input_vertices = h.input_vertices;
  p.input_triangles = h.input_triangles;
  p.repairs = {h.repairs[0], h.repairs[1], h.repairs[2], h.repairs[3], h.repairs[4], h.repairs[5], h.repairs[6]};
  p.fingerprint = h.fingerprint;
  p.simplifier = h.simplifier;
  p.cell_triangles = h.cell_triangles;
}

void take_levels(Hierarchy& hierarchy, std::span<const std::byte> bytes, const LodeHeader& header,
                 const std::string& file) {
  std::uint64_t cells = 0;
  for (std::uint32_t l = 0; l < header.level_count; ++l) {
    const auto r = record_at<LodeLevel>(bytes, sizeof(LodeHeader) + l * sizeof(LodeLevel));
    cells += r.cell_count;
    hierarchy.levels.push_back(
        {r.first_cell, r.cell_count, r.triangles, r.vertices, r.reach, r.diameter, r.error, r.max_edge, r.long_edges});
  }
  require(cells == header.cell_count, file, "level table", "the levels do not cover the cells");
}

// Spans of the cell's payload; the caller has made sure that it lies inside `bytes`.
class PayloadReader {
 public:
  explicit PayloadReader(const std::byte* at) : at_(at) {}
  template <typename T>
  [[nodiscard]] std::span<const T> take(std::size_t count) {
    const std::span<const T> items(reinterpret_cast<const T*>(at_), count);
    at_ += items.size_bytes();
    return items;
  }

 private:
  const std::byte* at_;
};

std::uint64_t payload_bytes(const LodeCell& r, bool root_level) {
  const std::uint64_t bytes =
      std::uint64_t{r.vertices} * (sizeof(Vec3f) + sizeof(PackedNormal) + (root_level ? 0 : sizeof(std::uint32_t))) +
      std::uint64_t{r.shared} * sizeof(std::uint32_t) + std::uint64_t{r.triangles} * sizeof(Triangle);
  return (bytes + lode_alignment - 1) / lode_alignment * lode_alignment;
}

Cell cell_of_record(const LodeCell& r, const std::byte* payload, bool root_level) {
  Cell cell;
  cell.code = {r.code};
  cell.parent = r.parent;
  cell.first_child = r.first_child;
  cell.child_count = r.child_count;
  cell.bounds = {{r.lo[0], r.lo[1], r.lo[2]}, {r.hi[0], r.hi[1], r.hi[2]}};
  cell.max_displacement = r.max_displacement;
  cell.error = r.error;
  PayloadReader reader(payload);
  cell.positions = reader.take<Vec3f>(r.vertices);
  cell.normals = reader.take<PackedNormal>(r.vertices);
  cell.parents = reader.take<std::uint32_t>(root_level ? 0 : r.vertices);
  cell.shared_ids = reader.take<std::uint32_t>(r.shared);
  cell.triangles = reader.take<Triangle>(r.triangles);
  return cell;
}

void take_cells(Hierarchy& hierarchy, std::span<const std::byte> bytes, const LodeHeader& header,
                const std::string& file) {
  const auto say = [&](bool holds, const char* what) { require(holds, file, "cell table", what); };
  std::uint64_t offset = header.payload_offset;
  std::uint64_t table = sizeof(LodeHeader) + header.level_count * sizeof(LodeLevel);
  hierarchy.cells.reserve(header.cell_count);
  for (std::size_t l = 0; l < hierarchy.levels.size(); ++l) {
    for (std::uint32_t i = 0; i < hierarchy.levels[l].cell_count; ++i, table += sizeof(LodeCell)) {
      const auto r = record_at<LodeCell>(bytes, table);
      const std::uint64_t size = payload_bytes(r, l == 0);
      say(r.offset == offset && size <= bytes.size() - offset, "a payload is not where it belongs");
      say(r.shared <= r.vertices, "more shared vertices than vertices");
      hierarchy.cells.push_back(cell_of_record(r, bytes.data() + offset, l == 0));
      offset += size;
    }
  }
  say(offset == bytes.size(), "the payloads do not fill the file");
}

}  // namespace

Hierarchy parse_lode_tables(std::span<const std::byte> bytes, std::shared_ptr<const void> storage,
                            const std::string& file) {
  const LodeHeader header = read_header(bytes, file);
  check_table_checksum(bytes, header, file);
  Hierarchy hierarchy;
  hierarchy.storage = std::move(storage);
  take_header(hierarchy, header);
  take_levels(hierarchy, bytes, header, file);
  take_cells(hierarchy, bytes, header, file);
  if (const std::string fault = table_fault(hierarchy); !fault.empty()) refuse(file, "tables", fault);
  return hierarchy;
}

void check_lode_cells(const Hierarchy& hierarchy, std::span<const std::byte> bytes, std::uint32_t first,
                      std::uint32_t end, const std::string& file) {
  const std::uint64_t table = sizeof(LodeHeader) + hierarchy.levels.size() * sizeof(LodeLevel);
  for (std::uint32_t c = first; c < end; ++c) {
    const Cell& cell = hierarchy.cells[c];
    const auto record = record_at<LodeCell>(bytes, table + std::uint64_t{c} * sizeof(LodeCell));
    const auto place = [&] { return "cell " + std::to_string(c); };
    if (XXH3_64bits(bytes.data() + record.offset, payload_bytes(record, cell.parent == no_cell)) != record.checksum)
      refuse(file, place(), "the checksum does not fit: the file was altered");
    if (const char* fault = payload_fault(hierarchy, c)) refuse(file, place(), fault);
  }
}

}  // namespace lodestone
