// Writes the .lode file from the cells of all ranks: the same bytes as save_lode.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/distributed/rank_signatures.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// The tables at rank 0: of all cells with their signatures, and of all vertices that cells share.
inline constexpr std::uint64_t table_bytes_per_cell = 700, table_bytes_per_shared = 1;

// The cells of a rank by level from the root, complete, and by code within a level: in memory or on disk.
class RankLevels {
 public:
  struct Summary : CellFigures {
    std::uint32_t vertices = 0, shared = 0, triangles = 0;
  };
  using Visit = std::function<void(const CellBuild&)>;

  virtual ~RankLevels() = default;
  [[nodiscard]] virtual std::size_t level_count() const = 0;
  [[nodiscard]] virtual std::span<const CellCode> codes(std::size_t level) const = 0;
  [[nodiscard]] virtual Summary summary(std::size_t level, std::size_t index) const = 0;
  // Calls visit(cell) with the payload. From any thread.
  virtual void visit(std::size_t level, std::size_t index, const Visit& visit) const = 0;
  // The vertices of a cell that others share, which may lie in the room.
  struct BorderRoom {
    std::vector<Vec3f> positions;
    std::vector<float> errors;
  };
  [[nodiscard]] virtual SharedBorder border(std::size_t level, std::size_t index, BorderRoom& room) const = 0;
  // Copies of vertices on borders that are compared at a time, when a level has so many (add_rank_signatures).
  [[nodiscard]] virtual std::uint64_t compared_copies(std::uint64_t copies) const = 0;
};

class RankLevelsInMemory final : public RankLevels {
 public:
  explicit RankLevelsInMemory(std::vector<CellPart>&& levels) : levels_(std::move(levels)) {}
  [[nodiscard]] std::size_t level_count() const override { return levels_.size(); }
  [[nodiscard]] std::span<const CellCode> codes(std::size_t level) const override { return levels_[level].codes; }
  [[nodiscard]] Summary summary(std::size_t level, std::size_t index) const override;
  void visit(std::size_t level, std::size_t index, const Visit& visit) const override {
    visit(levels_[level].cells[index]);
  }
  [[nodiscard]] SharedBorder border(std::size_t level, std::size_t index, BorderRoom& room) const override;
  [[nodiscard]] std::uint64_t compared_copies(std::uint64_t /*copies*/) const override { return all_copies; }

 private:
  std::vector<CellPart> levels_;
};

// Called by all ranks, with their cells. Rank 0 makes the tables, which complete `head` (transform, sigma0,
// provenance) at that rank alone, and creates the file under a temporary name; every rank writes the payloads of its
// cells where they belong. Then all call last_words(), for their last messages; when none has failed, rank 0 writes the
// rest and renames the file. Returns its size at rank 0. Memory: a mebibyte for each
// worker, what add_rank_signatures takes, and at rank 0 the tables.
std::uint64_t save_ranks(const RankLevels& levels, Hierarchy& head, const std::filesystem::path& path,
                         const std::function<void()>& last_words, Ranks& ranks, Scheduler& scheduler);

}  // namespace lodestone
