// The kernel of the build: merge the cells of a block on vertex identity, simplify, record P, split into parent cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/cell_build.h"
#include "core/hierarchy/cell_table.h"
#include "core/hierarchy/star_distance.h"
#include "core/simplify/simplifier.h"

namespace lodestone {

// Working memory of one worker, reused between blocks.
struct BlockScratch {
  // The merged mesh of the block.
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<std::uint32_t> ids;
  std::vector<UsageBox> usage;  // valid where shared
  std::vector<std::uint8_t> shared, locked;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> block_id;                  // of every vertex of every cell, cell after cell
  std::vector<std::uint32_t> table_keys, table_values;  // shared id -> block id
  // Splitting into the parents.
  std::vector<std::uint32_t> local, stamp, uses;
  std::vector<UsageBox> parent_usage;
  std::vector<Triangle> images;  // of the triangles under P, degenerate ones included
  StarDistance surface;          // of the images
  std::vector<std::uint32_t> members;
};

// `cells` and `parents` are the builds of levels block.level and block.level - 1, by rank. Fills the parents of the
// block and the `parents` arrays and displacement statistics of its cells, whose transient memory it releases.
void build_block(const Block& block, const LevelCells& parent_level, std::span<CellBuild> cells,
                 std::span<CellBuild> parents, float sigma0, Simplifier& simplifier, BlockScratch& scratch);

}  // namespace lodestone
