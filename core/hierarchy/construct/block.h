// The kernel of the build: merge the cells of a block on vertex identity, simplify, record P, split into parent cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/key_numbers.h"
#include "core/hierarchy/construct/block_errors.h"
#include "core/hierarchy/construct/block_normals.h"
#include "core/hierarchy/construct/block_wedges.h"
#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/cell_table.h"
#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Working memory of one worker, reused between blocks.
struct BlockScratch {
  // The merged mesh of the block.
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<std::uint32_t> ids;
  std::vector<std::uint8_t> locked;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> block_id;  // of every vertex of every cell, cell after cell
  std::vector<Vec2f> uv;                // these three only if the attributes have them
  std::vector<Rgba8> colours;
  std::vector<std::uint32_t> materials;
  // With wedges: their vertices.
  std::vector<std::uint32_t> vertex_ids;
  BlockWedges wedges;
  std::vector<UsageBox> vertex_usage;
  std::vector<std::uint64_t> vertex_used_by;
  std::vector<std::uint32_t> local_vertex;  // of each vertex of the parent being made
  // Vertices that cells share: their block ids, the union of their copies' usage, and how to find them.
  std::vector<std::uint32_t> shared;
  std::vector<UsageBox> usage;
  KeyNumbers<std::uint32_t> shared_ids;  // by index in `shared`
  // Splitting into the parents.
  std::vector<std::uint64_t> used_by;   // bit i: the i-th parent uses this survivor
  std::vector<std::uint32_t> members;   // survivors, parent after parent; may be longer
  std::vector<std::uint32_t> local;     // of a survivor in the parent being made
  std::vector<std::uint32_t> usage_of;  // index in `usage` of a locked vertex
  std::vector<Triangle> kept;           // of the parent being made; may be longer
  BlockNormals coarse_normals;
  std::vector<Float4> normal_sums;            // of the triangles at each vertex of the parent being made
  std::vector<std::uint32_t> shared_members;  // survivors that the parent being made shares, by local id
  BlockErrors errors;
};

struct BlockInput {
  const Block& block;
  const LevelCells& parent_level;
  std::span<CellBuild> cells, parents;  // builds of levels block.level and block.level - 1, by rank
  float sigma0 = 0;
  LevelGrids grids = {};
  AttributeSet attributes = {};
  Lattice lattice = {};  // vertices remain on it, if there is one
};

// Fills the parents of the block and the `parents` arrays and displacement statistics of its cells, whose transient
// memory it releases.
void build_block(const BlockInput& input, Simplifier& simplifier, BlockScratch& scratch);

}  // namespace lodestone
