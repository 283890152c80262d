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

// A vertex that cells share: its place, and the error of the surface around it within one of them.
struct SharedVertex {
  Vec3f position;
  float error = 0;
};

// Takes a level at a time, from the root, so that the cells need not be in memory together. Vertices are told apart by
// their positions: wedges of one position share a signature, as do vertices that happen to lie at the same place.
// Memory: 16 bytes per shared vertex of one level, 9 more while the level ends. Same table for any number of workers.
class SignatureFinder {
 public:
  // The hierarchy, of which the tables are enough, outlives this. `most`: signatures of a cell, from 2 on.
  explicit SignatureFinder(const Hierarchy& tables, std::size_t most = Signatures::most, Runner runner = {});

  void begin_level();  // the next one
  // Takes the shared vertices of a cell of the level: their positions, and border_errors, or else the cell's error for
  // all of them. From any thread, once for each cell.
  void add(CellId id, const Cell& cell);
  void end_level();

  // After all levels.
  [[nodiscard]] Signatures finish() && { return {tables_, std::move(table_)}; }

 private:
  [[nodiscard]] const Level& level() const { return tables_.levels[table_.sets.size()]; }

  const Hierarchy& tables_;
  std::size_t most_;
  Runner runner_;
  std::vector<std::vector<SharedVertex>> shared_;  // by rank
  Signatures::Table table_;
};

// Those of a hierarchy whose cells are all in memory.
[[nodiscard]] Signatures find_signatures(const Hierarchy& hierarchy, std::size_t most = Signatures::most);

// Those that the hierarchy has, or else those that are found.
[[nodiscard]] std::shared_ptr<const Signatures> signatures_of(const Hierarchy& hierarchy);

}  // namespace lodestone
