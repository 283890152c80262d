// Zipping within a box of space: the kernel of zip_seams, knows no threads.
//
// An advancing front from seam to seam: the incremental side of ball pivoting (bernardini1999) with the Delaunay choice
// of the third vertex, restricted to the borders of existing pieces (turklevoy1994 zips by clipping instead).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/reconstruct/seams/border_loops.h"
#include "render/reconstruct/seams/seam_mesh.h"

namespace lodestone {

// A cube of space. It handles an edge if all that may matter to it, the ball of radius `reach` around its middle, lies
// within.
struct ZipBox {
  Vec3f corner;
  float side = 0;
  [[nodiscard]] bool holds_ball(Vec3f middle, float radius) const {
    const Vec3f d = middle - corner;
    return d.x >= radius && d.y >= radius && d.z >= radius && d.x < side - radius && d.y < side - radius &&
           d.z < side - radius;
  }
};

// A triangle found by zipping: b, a, c at the border edge a -> b. `order` does not decrease: the largest circumscribed
// circle so far.
struct ZipTriangle {
  float order = 0;
  VertexId a, b, c;
};

struct ZipTask {
  ZipBox box;
  std::span<const VertexId> vertices;   // of the border, within the box
  std::span<const BorderEdgeId> edges;  // to begin with, all the box's business
};

struct ZipResult {
  std::vector<ZipTriangle> triangles;                // in the order in which they can be added
  std::vector<std::pair<VertexId, VertexId>> tried;  // edges that are left, without a triangle that fits
};

// Changes nothing of the seam and its borders. Deterministic, whatever else is zipped elsewhere at the same time.
[[nodiscard]] ZipResult zip_tile(const SeamMesh& seam, const BorderLoops& borders, const ZipConfig& config,
                                 const ZipTask& task);

}  // namespace lodestone
