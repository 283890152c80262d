#include "core/hierarchy/lode_file.h"

#include <vector>

#include "core/hierarchy/lode_format.h"
#include "core/io/atomic_file.h"
#include "core/io/mapped_file.h"

namespace lodestone {

// The tables come first and hold the checksums of what follows, so the payloads are encoded twice: once to be summed,
// once to be written. That is cheaper than holding the file in memory; the parallel twin writes at offsets instead.
void write_lode(const Hierarchy& hierarchy, const std::filesystem::path& path) {
  const LodeLayout layout = plan_lode(hierarchy);
  const std::vector<LodeChunk> chunks = lode_chunks(layout);
  std::vector<std::uint64_t> checksums(hierarchy.cells.size());
  std::vector<std::byte> buffer;
  for (const LodeChunk chunk : chunks) encode_lode_chunk(hierarchy, layout, chunk, buffer, checksums);

  AtomicFile file(path);
  file.write(encode_lode_tables(hierarchy, layout, checksums));
  for (const LodeChunk chunk : chunks) {
    encode_lode_chunk(hierarchy, layout, chunk, buffer, checksums);
    file.write(buffer);
  }
  file.commit();
}

Hierarchy open_lode(const std::filesystem::path& path) {
  const auto map = std::make_shared<const MappedFile>(path);
  Hierarchy hierarchy = parse_lode_tables(map->bytes(), map, path.string());
  check_lode_cells(hierarchy, map->bytes(), 0, static_cast<std::uint32_t>(hierarchy.cells.size()), path.string());
  return hierarchy;
}

}  // namespace lodestone
