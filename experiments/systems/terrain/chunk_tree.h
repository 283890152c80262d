// Chunked levels of detail of a height field (ulrich2002): a quadtree of chunks, each triangulated with the tolerance
// of its level. Chunks replace their parent; on the way there their posts move to where the parent has them. Chunks of
// different levels do not fit at their borders, and those of one level do not while they move: skirts cover that.
//
// Triangulations are those of right_triangles.h, on the finest level that of the surface itself. As published, except
// for the tolerances of levels, which are not halved but chosen for chunks of about equal numbers of triangles, and for
// the morph, which follows the error on the screen in proportion.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "experiments/systems/terrain/height_field.h"
#include "experiments/systems/terrain/right_triangles.h"

namespace lodestone {

struct Chunk {
  Square square;
  int level = 0;
  std::uint32_t parent = 0, first_child = 0, child_count = 0;
  Box3f box{};  // of all posts in the square
  std::vector<Post> posts{};
  std::vector<float> parent_heights{};  // of the posts, in the triangulation of the level above; of the root its own
  std::vector<Triangle> triangles{};    // of places in `posts`, as the surface turns its face
  std::vector<std::array<std::uint32_t, 2>> rim{};  // edges inside of the field, in the direction of their triangles
};

// A chunk that is drawn, and its share of the way to its parent.
struct DrawnChunk {
  std::uint32_t chunk = 0;
  float share = 0;
};

class ChunkTree {
 public:
  static constexpr int leaf_side = 32;

  explicit ChunkTree(const HeightField& field);  // that outlives it
  ChunkTree(const ChunkTree&) = delete;
  ChunkTree& operator=(const ChunkTree&) = delete;

  [[nodiscard]] std::span<const Chunk> chunks() const { return chunks_; }  // the root first
  [[nodiscard]] float tolerance(int level) const { return tolerances_[static_cast<std::size_t>(level)]; }
  [[nodiscard]] int finest() const { return static_cast<int>(tolerances_.size()) - 1; }

  // The coarsest chunks within the tolerance; an error of 1 is from `reach` on.
  [[nodiscard]] std::vector<DrawnChunk> chunks_for(Vec3f viewpoint, double reach) const;
  // The height at which a chunk draws one of its posts, and any post of its square.
  [[nodiscard]] float drawn_height(const DrawnChunk& drawn, std::size_t post) const;
  [[nodiscard]] float height_over(const DrawnChunk& drawn, Post post) const;
  // As deep as skirts must be: twice the tolerance of the level above.
  [[nodiscard]] float skirt_depth(int level) const { return 2 * tolerance(std::max(level - 1, 0)); }

 private:
  void plan();
  void choose_tolerances();
  void fill(Chunk& chunk) const;
  void triangulate(Chunk& chunk) const;
  void find_rim(Chunk& chunk) const;
  [[nodiscard]] Square parent_square(const Chunk& chunk) const { return chunks_[chunk.parent].square; }

  const HeightField& field_;
  RightTriangles triangles_;
  std::vector<Chunk> chunks_;
  std::vector<float> tolerances_;  // by level
};

}  // namespace lodestone
