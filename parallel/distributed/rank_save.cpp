#include "parallel/distributed/rank_save.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/files/atomic_file.h"
#include "core/hierarchy/construct/cell_table.h"
#include "core/hierarchy/lode/lode_format.h"
#include "parallel/distributed/messages/pieces.h"
#include "parallel/distributed/messages/slices.h"
#include "parallel/distributed/rank_signatures.h"
#include "parallel/hierarchy/level_table.h"

namespace lodestone {
namespace {

// A cell as rank 0 needs to know it.
struct CellRecord {
  CellCode code;
  std::uint32_t level = 0, vertices = 0, shared = 0, triangles = 0;
  CellFigures figures;
};

// Rank 0's answer about a cell.
struct CellPlace {
  std::uint64_t offset = 0;  // of the payload
  CellId id;
};

PayloadCounts counts_of_record(const CellRecord& cell, const AttributeSet& attributes, bool short_indices) {
  return {cell.vertices, cell.shared, cell.triangles, cell.level > 0, short_indices, attributes};
}

// A cell of a rank.
struct OwnCell {
  std::uint32_t level, index;  // within the rank's part of the level
};

// The tables of the file, at rank 0.
class Tables {
 public:
  // `records`: by rank, the cells of each in its order.
  Tables(const ByRank<CellRecord>& records, Hierarchy& head) : head_(head) {
    std::vector<std::uint64_t> sizes;
    for (const std::vector<CellRecord>& of_rank : records) sizes.push_back(of_rank.size());
    cells_of_ranks_ = Slices(sizes);
    // Reserved, since growing would take up to three times the memory.
    const std::uint64_t cells = cells_of_ranks_.total();
    std::vector<Entry> order;
    order.reserve(cells), counts_.reserve(cells), owners_.reserve(cells), head.cells.reserve(cells);
    for (std::uint32_t rank = 0; rank < records.size(); ++rank)
      for (std::uint32_t i = 0; i < records[rank].size(); ++i) order.push_back({&records[rank][i], rank, i});
    std::ranges::sort(order, {}, [](const Entry& e) { return std::pair(e.record->level, e.record->code); });
    const std::uint32_t finest = order.back().record->level;
    std::vector<CellCode> codes;
    for (const Entry& entry : order)
      if (entry.record->level == finest) codes.push_back(entry.record->code);
    const BlockPlan plan = plan_blocks(codes, static_cast<int>(finest), head.grids);
    std::size_t first = 0;
    for (std::size_t l = 0; l <= finest; ++l) {
      append_level(
          plan, l,
          [&](CellRank rank) {
            const CellRecord& record = *order[first + rank].record;
            return LevelEntry{&record.figures, record.vertices, record.triangles};
          },
          head);
      first = head.cells.size();
    }
    for (const Entry& entry : order) counts_.push_back(counts_of_record(*entry.record, head.attributes, false));
    layout_ = plan_lode(head, counts_);
    numbers_.resize(cells);
    for (std::uint32_t c = 0; c < order.size(); ++c) {
      numbers_[cells_of_ranks_.begin(static_cast<int>(order[c].rank)) + order[c].index] = CellId(c);
      owners_.push_back({static_cast<int>(order[c].rank), order[c].record->shared});
    }
    checksums_.resize(order.size());
  }

  // The cells of all ranks, of one rank after the other: whose the i-th is, and its place.
  [[nodiscard]] const Slices& cells_of_ranks() const { return cells_of_ranks_; }
  [[nodiscard]] CellPlace place(std::uint64_t i) const { return {layout_.cell_offset[numbers_[i]], numbers_[i]}; }
  [[nodiscard]] const LodeLayout& layout() const { return layout_; }
  [[nodiscard]] LevelBorders borders(std::size_t l) const {
    const Level& level = head_.levels[l];
    const auto first = owners_.begin() + std::uint32_t{level.first_cell};
    return {&level, {first, first + level.cell_count}};
  }
  void set_checksum(CellId cell, std::uint64_t checksum) { checksums_[cell] = checksum; }

  // Writes all but the payloads; returns the size of the file.
  std::uint64_t finish(const Signatures::Table& signatures, AtomicFile& file) const {
    const std::vector<std::byte> assets = encode_assets(head_, &signatures);
    file.write_at(layout_.payload_end(), assets);
    file.write_at(0, encode_lode_tables(head_, counts_, layout_, checksums_, assets));
    file.commit();
    return layout_.payload_end() + assets.size();
  }

 private:
  struct Entry {
    const CellRecord* record;
    std::uint32_t rank, index;
  };
  Hierarchy& head_;
  std::vector<PayloadCounts> counts_;  // by cell of the file
  LodeLayout layout_;
  std::vector<std::uint64_t> checksums_;
  Slices cells_of_ranks_;
  std::vector<CellId> numbers_;              // in that order
  std::vector<LevelBorders::Owner> owners_;  // by cell of the file
};

class RankSaver {
 public:
  RankSaver(const RankLevels& levels, Hierarchy& head, Ranks& ranks, Scheduler& scheduler)
      : levels_(levels), head_(head), ranks_(ranks), scheduler_(scheduler) {
    for (std::uint32_t l = 0; l < levels.level_count(); ++l) {
      first_of_level_.push_back(cells_.size());
      for (std::uint32_t c = 0; c < levels.codes(l).size(); ++c) cells_.push_back({l, c});
    }
    first_of_level_.push_back(cells_.size());
  }

  // Every rank gets the places of its cells.
  void make_tables() {
    ranks_.begin("placing cells");
    ByRank<CellRecord> records = by_rank<CellRecord>(ranks_);
    exchange_in_pieces<CellRecord>(
        ranks_, cells_.size(), [&](std::uint64_t i, const auto& emit) { emit(0, record(i)); },
        [&](int from, const std::vector<CellRecord>& some) {
          std::vector<CellRecord>& of_rank = records[static_cast<std::size_t>(from)];
          of_rank.insert(of_rank.end(), some.begin(), some.end());
        });
    if (is_first()) tables_.emplace(records, head_);
    ByRank<CellRecord>().swap(records);
    exchange_in_pieces<CellPlace>(
        ranks_, is_first() ? tables_->cells_of_ranks().total() : 0,
        [&](std::uint64_t i, const auto& emit) { emit(tables_->cells_of_ranks().owner(i), tables_->place(i)); },
        [&](int, const std::vector<CellPlace>& some) { places_.insert(places_.end(), some.begin(), some.end()); });
    short_indices_ = ranks_.any(is_first() && tables_->layout().short_indices);
  }

  void find_signatures() {
    for (std::size_t l = 0; l < levels_.level_count(); ++l) {
      ranks_.begin("signatures of level " + std::to_string(l));
      std::vector<RankBorder> own;
      std::uint64_t copies = 0;
      for (std::size_t i = first_of_level_[l]; i < first_of_level_[l + 1]; ++i) {
        own.push_back({places_[i].id, levels_.summary(l, cells_[i].index).shared});
        copies += own.back().shared;
      }
      RankLevels::BorderRoom room;
      add_rank_signatures(
          own, [&](std::size_t index) { return levels_.border(l, index, room); },
          is_first() ? tables_->borders(l) : LevelBorders(), signatures_, ranks_, levels_.compared_copies(copies));
    }
  }

  // Creates the file at rank 0, with room for all payloads, and opens it at the others.
  void open(const std::filesystem::path& path) {
    std::string name;
    if (is_first()) {
      file_ = std::make_unique<AtomicFile>(path);
      file_->reserve(tables_->layout().payload_end());
      name = std::filesystem::absolute(file_->written_path()).string();
    }
    name = ranks_.from_first(name);
    if (!is_first()) file_ = std::make_unique<AtomicFile>(path, name);
  }

  void write_payloads() {
    struct Checksum {
      CellId cell;
      std::uint64_t checksum;
    };
    ranks_.begin("writing");
    std::vector<Checksum> checksums(cells_.size());
    const std::vector<std::size_t> runs = find_runs();
    std::vector<std::vector<std::byte>> buffers(static_cast<std::size_t>(scheduler_.workers()));
    std::atomic<std::size_t> written = 0;
    scheduler_.for_chunks(runs.size() - 1, 1, [&](ChunkRange range) {
      std::vector<std::byte>& bytes = buffers[static_cast<std::size_t>(scheduler_.worker_index())];
      bytes.clear();
      for (std::size_t i = runs[range.begin]; i < runs[range.begin + 1]; ++i) {
        const std::size_t before = bytes.size();
        bytes.resize(before + payload_bytes(i));
        checksums[i] = {places_[i].id, encode(i, std::span(bytes).subspan(before))};
      }
      file_->write_at(places_[runs[range.begin]].offset, bytes);
      ranks_.done(static_cast<double>(++written) / static_cast<double>(runs.size() - 1));
    });
    if (!is_first()) file_->commit();
    exchange_in_pieces<Checksum>(
        ranks_, checksums.size(), [&](std::uint64_t i, const auto& emit) { emit(0, checksums[i]); },
        [&](int, const std::vector<Checksum>& some) {
          for (const Checksum& c : some) tables_->set_checksum(c.cell, c.checksum);
        });
  }

  std::uint64_t finish() {
    ranks_.tell_first();
    return is_first() ? tables_->finish(signatures_, *file_) : 0;
  }

 private:
  [[nodiscard]] bool is_first() const { return ranks_.rank() == 0; }
  [[nodiscard]] CellRecord record(std::size_t i) const {
    const auto [level, index] = cells_[i];
    const RankLevels::Summary cell = levels_.summary(level, index);
    return {levels_.codes(level)[index], level, cell.vertices, cell.shared, cell.triangles, cell};
  }
  [[nodiscard]] std::uint64_t payload_bytes(std::size_t i) const {
    return lode_aligned(plain_bytes(counts_of_record(record(i), head_.attributes, short_indices_)));
  }

  // Cells whose payloads follow each other in the file are written at once, a mebibyte at most or one cell: the first
  // cell of each run, and the end.
  [[nodiscard]] std::vector<std::size_t> find_runs() const {
    constexpr std::uint64_t run_bytes = 1u << 20;
    std::vector<std::size_t> runs;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (runs.empty() || places_[i].offset != places_[i - 1].offset + payload_bytes(i - 1) ||
          places_[i].offset - places_[runs.back()].offset >= run_bytes)
        runs.push_back(i);
    runs.push_back(cells_.size());
    return runs;
  }

  std::uint64_t encode(std::size_t i, std::span<std::byte> bytes) const {
    const auto [level, index] = cells_[i];
    std::uint64_t checksum = 0;
    levels_.visit(level, index, [&](const CellBuild& build) {
      Cell cell;
      cell.parent = cells_[i].level > 0 ? CellId(0) : no_cell;  // any: the payload has no more of it
      view_payload(build, cells_[i].level > 0, cell);
      checksum = encode_payload(cell, short_indices_, bytes);
    });
    return checksum;
  }

  const RankLevels& levels_;
  Hierarchy& head_;
  Ranks& ranks_;
  Scheduler& scheduler_;
  std::vector<OwnCell> cells_;  // by level, then code
  std::vector<std::size_t> first_of_level_;
  std::vector<CellPlace> places_;  // by own cell
  bool short_indices_ = false;
  std::unique_ptr<AtomicFile> file_;
  // At rank 0.
  std::optional<Tables> tables_;
  Signatures::Table signatures_;
};

}  // namespace

RankLevels::Summary RankLevelsInMemory::summary(std::size_t level, std::size_t index) const {
  const CellBuild& build = levels_[level].cells[index];
  return {build, static_cast<std::uint32_t>(build.vertex_count()),
          static_cast<std::uint32_t>(build.slab.shared_ids.size()), static_cast<std::uint32_t>(build.triangles.size())};
}

SharedBorder RankLevelsInMemory::border(std::size_t level, std::size_t index, BorderRoom& /*room*/) const {
  const CellBuild& cell = levels_[level].cells[index];
  return {std::span(cell.slab.positions).subspan(cell.first_shared()), cell.border_errors, cell.error};
}

std::uint64_t save_ranks(const RankLevels& levels, Hierarchy& head, const std::filesystem::path& path,
                         const std::function<void()>& last_words, Ranks& ranks, Scheduler& scheduler) {
  RankSaver saver(levels, head, ranks, scheduler);
  saver.make_tables();
  saver.find_signatures();
  saver.open(path);
  saver.write_payloads();
  last_words();
  return saver.finish();
}

}  // namespace lodestone
