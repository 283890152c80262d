#include "parallel/save.h"

#include <vector>

#include "core/hierarchy/lode_format.h"
#include "core/io/atomic_file.h"
#include "core/io/mapped_file.h"

namespace lodestone {

void save_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, Scheduler& scheduler) {
  const LodeLayout layout = plan_lode(hierarchy);
  const std::vector<LodeChunk> chunks = lode_chunks(layout);
  std::vector<std::uint64_t> checksums(hierarchy.cells.size());
  std::vector<std::vector<std::byte>> buffers(static_cast<std::size_t>(scheduler.workers()));
  AtomicFile file(path);
  scheduler.for_chunks(chunks.size(), 1, [&](ChunkRange range) {
    std::vector<std::byte>& buffer = buffers[static_cast<std::size_t>(scheduler.worker_index())];
    encode_lode_chunk(hierarchy, layout, chunks[range.begin], buffer, checksums);
    file.write_at(layout.cell_offset[chunks[range.begin].first_cell], buffer);
  });
  file.write_at(0, encode_lode_tables(hierarchy, layout, checksums));
  file.commit();
}

Hierarchy load_lode(const std::filesystem::path& path, Scheduler& scheduler) {
  constexpr std::size_t cells_per_task = 32;
  const auto map = std::make_shared<const MappedFile>(path);
  Hierarchy hierarchy = parse_lode_tables(map->bytes(), map, path.string());
  scheduler.for_chunks(hierarchy.cells.size(), cells_per_task, [&](ChunkRange range) {
    check_lode_cells(hierarchy, map->bytes(), static_cast<std::uint32_t>(range.begin),
                     static_cast<std::uint32_t>(range.end), path.string());
  });
  return hierarchy;
}

}  // namespace lodestone
