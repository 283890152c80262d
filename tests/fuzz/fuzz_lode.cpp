// .lode, plain and compressed: any bytes are either refused with an Error or give a hierarchy whose every index may be
// followed.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/hierarchy/lode/lode_format.h"

namespace {

using namespace lodestone;

// Sets sizes and checksums, so that they do not keep the fuzzer out.
void repair(std::byte* bytes, std::size_t size) {
  LodeHeader header;
  if (size < sizeof(header)) return;
  std::memcpy(&header, bytes, sizeof(header));
  header.magic = lode_magic;
  if (header.payload_offset > size || header.level_count > 16) return;
  header.asset_bytes = std::min<std::uint64_t>(header.asset_bytes, size - header.payload_offset);
  header.payload_bytes = size - header.payload_offset - header.asset_bytes;
  const std::uint64_t assets = size - header.asset_bytes;
  header.asset_checksum = checksum({bytes + assets, header.asset_bytes});
  for (std::size_t at = sizeof(header) + header.level_count * sizeof(LodeLevel);
       at + sizeof(LodeCell) <= header.payload_offset; at += sizeof(LodeCell)) {
    LodeCell cell, next;
    std::memcpy(&cell, bytes + at, sizeof(cell));
    next.offset = assets;
    if (at + 2 * sizeof(LodeCell) <= header.payload_offset)
      std::memcpy(&next, bytes + at + sizeof(LodeCell), sizeof(next));
    if (cell.offset <= next.offset && next.offset <= size)
      cell.checksum = checksum({bytes + cell.offset, next.offset - cell.offset});
    std::memcpy(bytes + at, &cell, sizeof(cell));
  }
  header.table_checksum = 0;
  std::memcpy(bytes, &header, sizeof(header));
  header.table_checksum = checksum({bytes, header.payload_offset});
  std::memcpy(bytes, &header, sizeof(header));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // The exact size, on the heap, aligned as a mapped file is: the sanitizer sees every step beyond the end.
  const auto bytes = std::shared_ptr<std::byte>(static_cast<std::byte*>(std::malloc(size)), std::free);
  if (size > 0) std::memcpy(bytes.get(), data, size);
  repair(bytes.get(), size);
  try {
    const std::span<const std::byte> view(bytes.get(), size);
    LodeReader reader(view, bytes, "fuzz");
    reader.check(CellId(0), CellId(reader.cell_count()));
    const Hierarchy h = std::move(reader).take();
    for (const Cell& cell : h.cells)
      for (const Triangle& t : cell.triangles)
        for (const std::uint32_t v : t.v)
          if (v >= cell.positions.size()) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
