#include "parallel/out_of_core/save_stored.h"

#include <algorithm>

#include "core/files/atomic_file.h"
#include "core/hierarchy/build/cell_order.h"
#include "core/hierarchy/lode/lode_assets.h"
#include "core/hierarchy/lode/lode_format.h"

namespace lodestone {
namespace {

constexpr std::size_t cells_per_task = 8;

std::vector<PayloadCounts> counts_of_cells(const StoredHierarchy& hierarchy) {
  std::vector<PayloadCounts> counts;
  for (std::size_t l = 0; l < hierarchy.cells.size(); ++l)
    for (const StoredCell& cell : hierarchy.cells[l])
      counts.push_back(counts_of(cell, l > 0, hierarchy.tables.attributes));
  return counts;
}

class StoredSaver {
 public:
  StoredSaver(const StoredHierarchy& hierarchy, const CellStore& store, const std::filesystem::path& path, bool order,
              Scheduler& scheduler, const std::function<void(std::size_t)>& done)
      : h_(hierarchy),
        store_(store),
        file_(path),
        order_(order),
        scheduler_(scheduler),
        done_(done),
        counts_(counts_of_cells(hierarchy)),
        checksums_(counts_.size()),
        scratch_(static_cast<std::size_t>(scheduler.workers())) {}

  std::uint64_t save_plain() {
    const LodeLayout layout = plan_lode(h_.tables, counts_);
    file_.reserve(layout.payload_end());
    for_levels([&](std::size_t l) {
      const std::size_t first = h_.tables.levels[l].first_cell;
      scheduler_.for_chunks(h_.cells[l].size(), cells_per_task, [&](ChunkRange range) {
        const std::uint64_t start = layout.cell_offset[first + range.begin];
        std::vector<std::byte> bytes(layout.cell_offset[first + range.end] - start);
        for_cells(l, range, [&](std::size_t c, const Cell& cell) {
          const std::uint64_t at = layout.cell_offset[c];
          checksums_[c] = encode_payload(cell, std::span(bytes).subspan(at - start, layout.cell_offset[c + 1] - at));
        });
        file_.write_at(start, bytes);
      });
    });
    return finish(layout);
  }

  // Sizes are known last, and the tables' is known first: payloads follow each other as they come, a few tasks at a
  // time.
  std::uint64_t save_compressed() {
    std::uint64_t at = plan_lode(h_.tables, counts_).table_bytes;
    std::vector<std::uint64_t> sizes(counts_.size());
    const std::size_t batch = 16 * cells_per_task * static_cast<std::size_t>(scheduler_.workers());
    for_levels([&](std::size_t l) {
      for (std::size_t begin = 0; begin < h_.cells[l].size(); begin += batch) {
        const std::size_t count = std::min(batch, h_.cells[l].size() - begin);
        for (const std::vector<std::byte>& bytes : compress(l, begin, count, sizes)) {
          file_.write_at(at, bytes);
          at += bytes.size();
        }
      }
    });
    return finish(plan_compressed_lode(h_.tables, sizes));
  }

 private:
  // Coarse to fine, so that cells know the new places in their parents.
  template <class Visit>
  void for_levels(const Visit& visit) {
    for (std::size_t l = 0; l < h_.cells.size(); ++l) {
      parents_moved_ = std::move(moved_);
      moved_.assign(order_ ? h_.cells[l].size() : 0, {});
      visit(l);
      if (done_) done_(h_.tables.levels[l].first_cell + h_.cells[l].size());
    }
  }

  std::vector<std::vector<std::byte>> compress(std::size_t l, std::size_t begin, std::size_t count,
                                               std::vector<std::uint64_t>& sizes) {
    std::vector<std::vector<std::byte>> payloads(chunk_count(count, cells_per_task));
    scheduler_.for_chunks(count, cells_per_task, [&](ChunkRange range) {
      std::vector<std::byte>& bytes = payloads[range.index];
      for_cells(l, {begin + range.begin, begin + range.end, 0}, [&](std::size_t c, const Cell& cell) {
        const std::size_t before = bytes.size();
        checksums_[c] = append_compressed_payload(cell, h_.tables.transform.lattice, bytes);
        sizes[c] = bytes.size() - before;
      });
    });
    return payloads;
  }

  // Calls visit(index in the tables, cell) for the cells of a level with these ranks, with their payloads.
  template <class Visit>
  void for_cells(std::size_t l, ChunkRange ranks, const Visit& visit) {
    for (std::size_t rank = ranks.begin; rank < ranks.end; ++rank) {
      const std::size_t c = h_.tables.levels[l].first_cell + rank;
      CellBuild build;
      store_.get_payload(h_.cells[l][rank], l > 0, build);
      Cell cell = h_.tables.cells[c];
      if (order_) order(build, l, rank, cell.parent);
      view_payload(build, l > 0, cell);
      visit(c, cell);
    }
  }

  void order(CellBuild& build, std::size_t l, std::size_t rank, std::uint32_t parent) {
    CellOrderScratch& scratch = scratch_[static_cast<std::size_t>(scheduler_.worker_index())];
    std::vector<std::uint32_t> moved = order_cell(build, scratch);
    if (l > 0) order_parents(build, moved, parents_moved_[parent - h_.tables.levels[l - 1].first_cell], scratch);
    if (l + 1 < h_.cells.size()) moved_[rank] = std::move(moved);
  }

  std::uint64_t finish(const LodeLayout& layout) {
    const std::vector<std::byte> assets = encode_assets(h_.tables);
    if (!assets.empty()) file_.write_at(layout.payload_end(), assets);
    file_.write_at(0, encode_lode_tables(h_.tables, counts_, layout, checksums_, assets));
    file_.commit();
    return layout.payload_end() + assets.size();
  }

  const StoredHierarchy& h_;
  const CellStore& store_;
  AtomicFile file_;
  bool order_;
  Scheduler& scheduler_;
  const std::function<void(std::size_t)>& done_;
  std::vector<PayloadCounts> counts_;
  std::vector<std::uint64_t> checksums_;
  std::vector<CellOrderScratch> scratch_;
  std::vector<std::vector<std::uint32_t>> moved_, parents_moved_;  // of this level and the next coarser one, by rank
};

}  // namespace

std::uint64_t save_stored(const StoredHierarchy& hierarchy, const CellStore& store, const std::filesystem::path& path,
                          LodeForm form, bool order, Scheduler& scheduler,
                          const std::function<void(std::size_t)>& done) {
  StoredSaver saver(hierarchy, store, path, order, scheduler, done);
  return form == LodeForm::compressed ? saver.save_compressed() : saver.save_plain();
}

}  // namespace lodestone
