// Normals of the vertices that a block leaves: turned towards the coarser surface where that has left them behind.
//
// A vertex keeps the normal of the finest level as long as it survives. Where folds and thin parts are smoothed away,
// the triangles around it face elsewhere in the end, and it would be lit as if they did not. Its normal is turned until
// it is within 20 degrees of their mean, weighted by area: not all the way, since models may bring normals of their
// own, but the farther, the more it has lost touch with them; one that was 60 degrees off becomes the mean. One normal
// of a vertex remains one normal, whatever wedges the vertex has: a seam of texture coordinates does not show, unless
// the surface folds there: wedges whose own triangles' mean is more than 30 degrees off that of all get their own.
// Different normals of a vertex, at a crease, are turned separately, each by the triangles of its wedges.
//
// Thin parts that have lost their sides have normals whose triangles face far apart. A mean does not serve there: a
// normal that is more than 60 degrees off one of its triangles is replaced by facing_normal.
//
// Most vertices belong to one cell: they are done when it is, while it is in the cache, four at a time, and the sums of
// its triangles come with its other figures (measure_cell).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/math/lanes/float4.h"
#include "core/math/vec3.h"

namespace lodestone {

// Working memory of one worker, reused between blocks.
class BlockNormals {
 public:
  struct Block {
    std::span<const std::uint8_t> locked;   // of each survivor, an id of the block; non-zero: its normal remains
    std::span<const std::uint32_t> vertex;  // of each survivor, with wedges; empty: each is a vertex
    std::size_t vertices = 0;
  };
  // The spans must outlive the calls below.
  void begin(const Block& block);

  // A cell of the coarser level. Its survivors have local ids, those that other cells use too behind its own.
  struct CoarseCell {
    std::span<PackedNormal> normals;  // turned where they have to be
    std::span<Float4> sums;           // of the triangles at each, as measure_cell adds them up
    std::span<const Vec3f> positions;
    std::span<const Triangle> triangles;
    std::span<const std::uint32_t> vertex;  // of each, with wedges; empty: each is a vertex
    std::span<const std::uint32_t> shared;  // ids in the block of those that other cells use too
  };
  // Turns the normals of the cell's own survivors, and keeps what is needed of the others.
  void add(const CoarseCell& cell);
  // Turns the others' normals, in the arrays of their cells. After all cells of the block.
  void finish();

 private:
  void turn(std::span<const std::uint32_t> vertex, std::span<PackedNormal> normals, std::span<Float4> sums);
  void find_far(std::span<const PackedNormal> normals, std::span<const Float4> sums);
  void find_same(std::span<const std::uint32_t> vertex, std::span<const PackedNormal> normals);
  void join(std::span<Float4> sums);

  struct Corner {
    std::uint32_t spread = 0;
    Vec3d triangle;  // cross product of two sides
  };
  struct Cell {
    std::span<PackedNormal> normals;
    std::span<const Vec3f> positions;
    std::span<const Triangle> triangles;
    std::size_t own = 0;    // vertices before those that other cells use, too
    std::size_t first = 0;  // of its entries in spread_of_
  };
  void list_spread(std::span<const PackedNormal> normals, std::span<const Float4> sums,
                   std::span<std::uint32_t> spread_of);
  void gather_corners();
  void face_corners();

  std::vector<std::uint32_t> far_;    // to be turned, or to be compared once more
  std::vector<std::uint32_t> first_;  // of each vertex of the block; set while wedges are joined
  std::vector<std::uint32_t> next_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> same_;
  // Sums of wedges that have one normal, at the first of them: of all, and of those that keep it together.
  std::vector<Float4> all_, joined_;
  Block block_;
  // Survivors that several cells use, and where these have their normals.
  std::vector<std::uint32_t> shared_, shared_vertices_;
  std::vector<std::uint32_t> first_use_;  // by survivor: its place above, or none
  std::vector<PackedNormal> shared_normals_;
  std::vector<Float4> shared_sums_;
  std::vector<std::pair<PackedNormal*, std::uint32_t>> places_;
  // Normals whose triangles face apart, by number, which wedges that have one normal share.
  std::vector<PackedNormal> spread_;
  std::vector<std::uint32_t> spread_of_;  // of the vertices of all cells: the number, or none
  std::vector<std::uint32_t> shared_spread_of_;
  std::vector<Cell> cells_;
  std::vector<Corner> corners_;
};

}  // namespace lodestone
