// libFuzzer: any bytes are either refused with an Error or give a hierarchy whose every index may be followed.
//
// Plain and compressed files alike. Checksums would keep a fuzzer out, so they are made to fit first: `repair` copies
// what the checks expect into place. Start from a corpus of small files: `lodestone build`, with and without
// --compress.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_format.h"

namespace {

using namespace lodestone;

void repair(std::byte* bytes, std::size_t size) {
  if (size < sizeof(LodeHeader)) return;
  LodeHeader header;
  std::memcpy(&header, bytes, sizeof(header));
  header.magic = lode_magic;
  header.table_checksum = 0;
  std::memcpy(bytes, &header, sizeof(header));
  if (header.payload_offset > size || header.level_count > 16) return;
  std::size_t at = sizeof(LodeHeader) + header.level_count * sizeof(LodeLevel);
  for (; at + sizeof(LodeCell) <= header.payload_offset; at += sizeof(LodeCell)) {
    LodeCell cell, next;
    std::memcpy(&cell, bytes + at, sizeof(cell));
    std::uint64_t end = size;
    if (at + 2 * sizeof(LodeCell) <= header.payload_offset) {
      std::memcpy(&next, bytes + at + sizeof(LodeCell), sizeof(next));
      end = next.offset;
    }
    if (cell.offset <= end && end <= size) cell.checksum = XXH3_64bits(bytes + cell.offset, end - cell.offset);
    std::memcpy(bytes + at, &cell, sizeof(cell));
  }
  header.table_checksum = XXH3_64bits(bytes, header.payload_offset);
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
