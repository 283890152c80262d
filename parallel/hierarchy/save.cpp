#include "parallel/hierarchy/save.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/files/atomic_file.h"
#include "core/files/input_file.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/model/find_signatures.h"
#include "parallel/scheduler/runner.h"

namespace lodestone {
namespace {

class LodeSaver {
 public:
  LodeSaver(CellSource& source, const std::filesystem::path& path, Scheduler& scheduler,
            const std::function<void(std::size_t)>& progress)
      : source_(source),
        file_(path),
        scheduler_(scheduler),
        progress_(progress),
        counts_(source.counts()),
        plain_(plan_lode(source.tables(), counts_)),
        checksums_(counts_.size()) {
    if (!source.tables().signatures) finder_.emplace(source.tables(), Signatures::most, runner_over(scheduler));
  }

  std::uint64_t save_plain() {
    std::vector<std::vector<std::byte>> buffers(static_cast<std::size_t>(scheduler_.workers()));
    file_.reserve(plain_.payload_end());
    const auto offset = [&](std::uint32_t cell) { return plain_.cell_offset[cell]; };
    for_levels([&](std::span<const LodeChunk> chunks) {
      scheduler_.for_chunks(chunks.size(), 1, [&](ChunkRange range) {
        const LodeChunk chunk = chunks[range.begin];
        std::vector<std::byte>& bytes = buffers[static_cast<std::size_t>(scheduler_.worker_index())];
        bytes.resize(offset(chunk.end_cell) - offset(chunk.first_cell));
        for (CellId c = chunk.first_cell; c < chunk.end_cell; ++c)
          source_.visit(c, [&](const Cell& cell) {
            checksums_[c] = encode_payload(
                cell, plain_.short_indices,
                std::span(bytes).subspan(offset(c) - offset(chunk.first_cell), offset(c + 1) - offset(c)));
            find_signatures(c, cell);
          });
        file_.write_at(offset(chunk.first_cell), bytes);
      });
    });
    return finish(plain_);
  }

  // Sizes are known last, and the tables' is known first: payloads follow each other as they come, some at a time.
  std::uint64_t save_compressed() {
    std::uint64_t at = plain_.table_bytes;
    std::vector<std::uint64_t> sizes(counts_.size());
    std::vector<std::vector<std::byte>> payloads(16 * static_cast<std::size_t>(scheduler_.workers()));
    for_levels([&](std::span<const LodeChunk> chunks) {
      for (std::size_t begin = 0; begin < chunks.size(); begin += payloads.size()) {
        const std::size_t count = std::min(payloads.size(), chunks.size() - begin);
        scheduler_.for_chunks(
            count, 1, [&](ChunkRange range) { compress(chunks[begin + range.begin], payloads[range.begin], sizes); });
        for (std::size_t i = 0; i < count; ++i) {
          file_.write_at(at, payloads[i]);
          at += payloads[i].size();
        }
      }
    });
    return finish(plan_compressed_lode(source_.tables(), sizes));
  }

 private:
  // Calls visit with the chunks of each level.
  template <class Visit>
  void for_levels(const Visit& visit) {
    constexpr std::uint64_t chunk_bytes = 1u << 20;
    const std::vector<Level>& levels = source_.tables().levels;
    std::vector<LodeChunk> chunks;
    for (std::size_t l = 0; l < levels.size(); ++l) {
      const std::uint32_t end = levels[l].end_cell();
      chunks.clear();
      for (CellId c = levels[l].first_cell; c < end; ++c)
        if (chunks.empty() || plain_.cell_offset[c] - plain_.cell_offset[chunks.back().first_cell] >= chunk_bytes) {
          chunks.push_back({c, CellId(c + 1)});
        } else {
          chunks.back().end_cell = CellId(c + 1);
        }
      source_.begin_level(l);
      if (finder_) finder_->begin_level();
      visit(chunks);
      if (finder_) finder_->end_level();
      if (progress_) progress_(end);
    }
  }

  void find_signatures(CellId id, const Cell& cell) {
    if (!finder_) return;
    if (source_.keeps_payloads()) {
      finder_->add(id, cell);
    } else {
      finder_->add_copy(id, cell);
    }
  }

  void compress(LodeChunk chunk, std::vector<std::byte>& bytes, std::vector<std::uint64_t>& sizes) {
    bytes.clear();
    for (CellId c = chunk.first_cell; c < chunk.end_cell; ++c) {
      const std::size_t before = bytes.size();
      source_.visit(c, [&](const Cell& cell) {
        checksums_[c] = append_compressed_payload(cell, source_.tables().transform.lattice, bytes);
        find_signatures(c, cell);
      });
      sizes[c] = bytes.size() - before;
    }
  }

  // Writes the assets after the payloads and the tables before them; returns the size of the file.
  std::uint64_t finish(const LodeLayout& layout) {
    const Signatures::Table found = finder_ ? std::move(*finder_).finish() : Signatures::Table{};
    const std::vector<std::byte> assets =
        encode_assets(source_.tables(), finder_ ? &found : &source_.tables().signatures->table());
    file_.write_at(layout.payload_end(), assets);
    file_.write_at(0, encode_lode_tables(source_.tables(), counts_, layout, checksums_, assets));
    file_.commit();
    return layout.payload_end() + assets.size();
  }

  CellSource& source_;
  AtomicFile file_;
  Scheduler& scheduler_;
  const std::function<void(std::size_t)>& progress_;
  std::vector<PayloadCounts> counts_;
  LodeLayout plain_;
  std::vector<std::uint64_t> checksums_;
  std::optional<SignatureFinder> finder_;  // where the source has none
};

}  // namespace

std::vector<PayloadCounts> CellSource::counts() const {
  std::vector<PayloadCounts> counts;
  for (const Cell& cell : hierarchy_.cells) counts.push_back(counts_of(cell));
  return counts;
}

std::uint64_t save_lode(CellSource& source, const std::filesystem::path& path, Scheduler& scheduler, LodeForm form,
                        const std::function<void(std::size_t)>& progress) {
  LodeSaver saver(source, path, scheduler, progress);
  return form == LodeForm::compressed ? saver.save_compressed() : saver.save_plain();
}

std::uint64_t save_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, Scheduler& scheduler,
                        LodeForm form) {
  CellSource source(hierarchy);
  return save_lode(source, path, scheduler, form);
}

Hierarchy load_lode(const std::filesystem::path& path, Scheduler& scheduler) {
  constexpr std::size_t cells_per_task = 32;
  const auto map = std::make_shared<const MappedFile>(path);
  LodeReader reader(map->bytes(), map, path.string());
  scheduler.for_chunks(reader.cell_count(), cells_per_task,
                       [&](ChunkRange range) { reader.check(CellId(range.begin), CellId(range.end)); });
  return std::move(reader).take();
}

}  // namespace lodestone
