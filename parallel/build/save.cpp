#include "parallel/build/save.h"

#include <vector>

#include "core/files/atomic_file.h"
#include "core/files/mapped_file.h"
#include "core/hierarchy/lode/lode_assets.h"
#include "core/hierarchy/lode/lode_format.h"

namespace lodestone {

namespace {

// Tables in front of the payloads and assets behind them; returns the size of the file.
std::uint64_t save_tables(const Hierarchy& hierarchy, const LodeLayout& layout,
                          std::span<const std::uint64_t> checksums, AtomicFile& file) {
  const std::vector<std::byte> assets = encode_assets(hierarchy);
  if (!assets.empty()) file.write_at(layout.payload_end(), assets);
  file.write_at(0, encode_lode_tables(hierarchy, layout, checksums, assets));
  return layout.payload_end() + assets.size();
}

std::uint64_t save_plain(const Hierarchy& hierarchy, AtomicFile& file, Scheduler& scheduler) {
  const LodeLayout layout = plan_lode(hierarchy);
  const std::vector<LodeChunk> chunks = lode_chunks(layout);
  std::vector<std::uint64_t> checksums(hierarchy.cells.size());
  std::vector<std::vector<std::byte>> buffers(static_cast<std::size_t>(scheduler.workers()));
  file.reserve(layout.payload_end());
  scheduler.for_chunks(chunks.size(), 1, [&](ChunkRange range) {
    std::vector<std::byte>& buffer = buffers[static_cast<std::size_t>(scheduler.worker_index())];
    encode_lode_chunk(hierarchy, layout, chunks[range.begin], buffer, checksums);
    file.write_at(layout.cell_offset[chunks[range.begin].first_cell], buffer);
  });
  return save_tables(hierarchy, layout, checksums, file);
}

std::uint64_t save_compressed(const Hierarchy& hierarchy, AtomicFile& file, Scheduler& scheduler) {
  const std::vector<LodeChunk> chunks = lode_chunks(plan_lode(hierarchy), 1u << 20);
  std::vector<std::uint64_t> sizes(hierarchy.cells.size()), checksums(hierarchy.cells.size());
  std::vector<std::vector<std::byte>> payloads(chunks.size());
  scheduler.for_chunks(chunks.size(), 1, [&](ChunkRange range) {
    compress_lode_chunk(hierarchy, chunks[range.begin], payloads[range.begin], sizes, checksums);
  });
  const LodeLayout layout = plan_compressed_lode(hierarchy, sizes);
  file.reserve(layout.payload_end());
  scheduler.for_chunks(chunks.size(), 1, [&](ChunkRange range) {
    file.write_at(layout.cell_offset[chunks[range.begin].first_cell], payloads[range.begin]);
    payloads[range.begin] = {};
  });
  return save_tables(hierarchy, layout, checksums, file);
}

}  // namespace

std::uint64_t save_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, Scheduler& scheduler,
                        LodeForm form) {
  AtomicFile file(path);
  const std::uint64_t bytes = form == LodeForm::compressed ? save_compressed(hierarchy, file, scheduler)
                                                           : save_plain(hierarchy, file, scheduler);
  file.commit();
  return bytes;
}

Hierarchy load_lode(const std::filesystem::path& path, Scheduler& scheduler) {
  constexpr std::size_t cells_per_task = 32;
  const auto map = std::make_shared<const MappedFile>(path);
  LodeReader reader(map->bytes(), map, path.string());
  scheduler.for_chunks(reader.cell_count(), cells_per_task, [&](ChunkRange range) {
    reader.check(static_cast<std::uint32_t>(range.begin), static_cast<std::uint32_t>(range.end));
  });
  return std::move(reader).take();
}

}  // namespace lodestone
