// Finds the signatures of a hierarchy (core/hierarchy/model/signatures.h) from the positions of shared vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/runner.h"
#include "core/hierarchy/model/signatures.h"

namespace lodestone {

// The vertices of a cell that others share: their places, and the errors of the surface around them within the cell.
struct BorderVertices {
  std::span<const Vec3f> positions;
  std::span<const float> errors;  // by vertex; empty: all have the cell's
  float cell_error = 0;
  std::vector<Vec3f> own_positions;  // if the cell's are not there when the level ends
  std::vector<float> own_errors;

  [[nodiscard]] float error(std::size_t k) const { return errors.empty() ? cell_error : errors[k]; }
};

// Takes a level at a time, from the root, so that the cells need not be in memory together. Vertices are told apart by
// their positions: wedges of one position share a signature, as do vertices that happen to lie at the same place.
// Memory: 9 bytes per shared vertex of a level while it ends, and 12 more where cells do not remain, 16 with errors.
// Same table for any number of workers.
class SignatureFinder {
 public:
  // The hierarchy, of which the tables are enough, outlives this. `most`: signatures of a cell, from 2 on.
  explicit SignatureFinder(const Hierarchy& tables, std::size_t most = Signatures::most, Runner runner = {});

  void begin_level();  // the next one
  // Takes the shared vertices of a cell of the level: their positions, and border_errors, or else the cell's error for
  // all of them. From any thread, once for each cell. Its arrays remain until the level ends.
  void add(CellId id, const Cell& cell);
  // The same for a cell whose arrays do not.
  void add_copy(CellId id, const Cell& cell);
  void end_level();

  // After all levels.
  [[nodiscard]] Signatures::Table finish() && { return std::move(table_); }

 private:
  [[nodiscard]] const Level& level() const { return tables_.levels[table_.sets.size()]; }

  const Hierarchy& tables_;
  std::size_t most_;
  Runner runner_;
  std::vector<BorderVertices> shared_;  // by rank
  Signatures::Table table_;
};

// Those of a hierarchy whose cells are all in memory.
[[nodiscard]] Signatures find_signatures(const Hierarchy& hierarchy, std::size_t most = Signatures::most);

// Those that the hierarchy has, or else those that are found.
[[nodiscard]] std::shared_ptr<const Signatures> signatures_of(const Hierarchy& hierarchy);

}  // namespace lodestone
