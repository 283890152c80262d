// Normals of the vertices that a block leaves: turned towards the coarser surface where that has left them behind.
//
// A vertex keeps the normal of the finest level as long as it survives. Where folds and thin parts are smoothed away,
// the triangles around it face elsewhere in the end, and it would be lit as if they did not. Its normal is turned until
// it is within 20 degrees of their mean, weighted by area: not all the way, since models may bring normals of their
// own. One normal of a vertex remains one normal, whatever wedges the vertex has: a seam of texture coordinates does
// not show. Different normals of a vertex, at a crease, are turned separately, each by the triangles of its wedges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/math/lanes/float4.h"

namespace lodestone {

// Working memory of one worker, reused between blocks. Survivors have ids of the block.
class BlockNormals {
 public:
  struct Block {
    std::span<const std::uint32_t> survivors;  // may occur several times
    std::span<const PackedNormal> normals;     // of all ids, as they are
    std::span<const std::uint32_t> vertex;     // of all ids, with wedges; empty: each is a vertex
    std::size_t vertices = 0;                  // with wedges
  };
  // The spans must outlive the calls below.
  void begin(const Block& block);

  // A cell of the coarser level; `local` of each of its survivors is the index that positions and triangles have for
  // it.
  struct CoarseCell {
    std::span<const std::uint32_t> survivors;
    std::span<const std::uint32_t> local;
    std::span<const Vec3f> positions;
    std::span<const Triangle> triangles;
  };
  void add(const CoarseCell& cell);

  // After all cells that have triangles at the survivor.
  [[nodiscard]] PackedNormal turned(std::uint32_t survivor) const;

 private:
  void group_wedges();
  [[nodiscard]] std::uint32_t first_with_normal(std::uint32_t survivor) const {
    return block_.vertex.empty() ? survivor : same_normal_[survivor];
  }

  Block block_;
  std::vector<Float4> sums_;       // by survivor: normals of triangles times twice their areas
  std::vector<Float4> cell_sums_;  // of one cell
  // With wedges: of each survivor the first of its vertex with the same normal, which has the sum of all of them; of
  // each vertex, and from there on, the wedges with different normals.
  std::vector<std::uint32_t> same_normal_, first_normal_, next_normal_;
};

}  // namespace lodestone
