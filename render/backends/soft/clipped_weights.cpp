#include "render/backends/soft/clipped_weights.h"

#include <algorithm>

namespace lodestone::soft {

std::array<ClipVertex, 3> clip_corners(const ViewProjection& projection, const DrawnCell& cell, const VertexIds& v) {
  std::array<ClipVertex, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f p =
        cell.morphing ? morph_vertex(cell.model->morph, cell.cell, v[k]).position : cell.own->positions[v[k]];
    corners[k] = to_clip(projection, p);
  }
  return corners;
}

std::array<float, 3> clipped_weights(const DrawnCell& cell, const VertexIds& v, const Viewport& viewport,
                                     SnappedPoint at) {
  const std::array<ClipVertex, 3> corner = clip_corners(cell.model->view_projection, cell, v);
  // The ray through the pixel in coordinates (x, y, w): the weights solve sum of weight (x, y, w) = (nx, ny, 1) times
  // something.
  const double nx = at.x / static_cast<double>(viewport.half_width()) - 1,
               ny = 1 - at.y / static_cast<double>(viewport.half_height());
  std::array<double, 3> weight;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const ClipVertex &p = corner[(k + 1) % 3], &q = corner[(k + 2) % 3];
    weight[k] = nx * (double{p.y} * q.w - double{p.w} * q.y) + ny * (double{p.w} * q.x - double{p.x} * q.w) +
                (double{p.x} * q.y - double{p.y} * q.x);
  }
  for (double& w : weight) sum += w;
  // Snapping and clipping have moved the border by a fraction of a subpixel: the pixel may lie just outside.
  double kept = 0;
  for (double& w : weight) kept += w = sum == 0 ? 1 : std::max(w / sum, 0.0);
  std::array<float, 3> result;
  for (std::size_t k = 0; k < 3; ++k) result[k] = static_cast<float>(weight[k] / kept);
  return result;
}

}  // namespace lodestone::soft
