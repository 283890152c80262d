// A build by many ranks as the tables of the finished file tell it: which rank has which cells, and how many bytes move
// between them, computed without running a rank. Nothing is measured here: time follows by a model of the costs.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

struct PlanConfig {
  int ranks = 2;  // at least 1
  // The triangles by which the ranks' borders are chosen. A build looks at every so many of its input; the file does
  // not know that order. 0: evenly spread over the cells, as in an input that is ordered in space; otherwise drawn at
  // random from this seed, as in one without order. They are the same where all triangles are looked at (up to 2^17).
  std::uint64_t seed = 0;
};

// The ranks at work on a level: they run its blocks, and get its cells from those that have run the finer ones.
struct LevelPlan {
  std::uint64_t cells = 0, triangles = 0, blocks = 0;
  int busy_ranks = 0;                // that have a block of the level; of the root: its cell
  std::uint64_t most_triangles = 0;  // of a rank
  // Cells that come from another rank than that which needs them; none on the finest level, whose cells do not move.
  std::uint64_t moved_cells = 0, moved_bytes = 0;
  std::uint64_t most_sent = 0, most_received = 0;  // bytes of a rank
  std::uint64_t largest_message = 0;               // bytes of cells that a rank sends to another one in a round
  std::uint64_t rounds = 0;                        // in which the cells move
};

struct RankPlan {
  int ranks = 0;
  std::vector<LevelPlan> levels;  // from the root
  std::uint64_t samples = 0;      // triangles by which the borders are chosen
  double imbalance = 1;           // of the finest level's triangles: maximum over mean
  // Vertices of the finest level that several ranks use, once for each of those; and of one rank at most. Too many by
  // some where a cell has more than 255 signatures.
  std::uint64_t border_vertices = 0, most_border_vertices = 0;
  // Memory of rank 0 for the tables of all cells, as save_ranks states it; its other stages may need as much.
  std::uint64_t first_rank_bytes = 0;

  [[nodiscard]] std::uint64_t moved_bytes() const;
};

// Bytes are those of the cells' messages without what Ranks puts before each, which is 32 bytes, and once where they
// go by way of another rank. Complexity: cells and
// shared vertices. Memory: 24 bytes per cell, and per rank a few numbers.
[[nodiscard]] RankPlan plan_ranks(const Hierarchy& hierarchy, const PlanConfig& config);

}  // namespace lodestone
