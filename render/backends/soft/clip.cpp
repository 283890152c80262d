#include "render/backends/soft/clip.h"

#include <algorithm>

namespace lodestone::soft {
namespace {

// Signed distance from a plane, in units of w; not negative inside.
using PlaneDistance = float (*)(const ClipVertex&, const Viewport&);

constexpr std::array<PlaneDistance, 7> planes{
    [](const ClipVertex& v, const Viewport&) { return v.z + v.w; },
    [](const ClipVertex& v, const Viewport&) { return v.w - v.z; },
    [](const ClipVertex& v, const Viewport& p) { return p.guard_x() * v.w + v.x; },
    [](const ClipVertex& v, const Viewport& p) { return p.guard_x() * v.w - v.x; },
    [](const ClipVertex& v, const Viewport& p) { return p.guard_y() * v.w + v.y; },
    [](const ClipVertex& v, const Viewport& p) { return p.guard_y() * v.w - v.y; },
    [](const ClipVertex& v, const Viewport&) { return v.kept; },
};

// Always from the inner end to the outer one, whichever way the polygon runs: neighbours agree on the point.
ClipVertex crossing(const ClipVertex& in, const ClipVertex& out, float distance_in, float distance_out) {
  const float t = distance_in / (distance_in - distance_out);
  const auto mix = [t](float a, float b) { return a + t * (b - a); };
  return {mix(in.x, out.x), mix(in.y, out.y), mix(in.z, out.z), mix(in.w, out.w), mix(in.kept, out.kept)};
}

ClippedPolygon clip_to(const ClippedPolygon& polygon, PlaneDistance distance, const Viewport& viewport) {
  ClippedPolygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const ClipVertex& from = polygon.corners[static_cast<std::size_t>(i)];
    const ClipVertex& to = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
    const float d_from = distance(from, viewport), d_to = distance(to, viewport);
    const auto keep = [&](const ClipVertex& v) { kept.corners[static_cast<std::size_t>(kept.count++)] = v; };
    if (d_from >= 0) keep(from);
    if (d_from >= 0 && d_to < 0) keep(crossing(from, to, d_from, d_to));
    if (d_from < 0 && d_to >= 0) keep(crossing(to, from, d_to, d_from));
  }
  return kept;
}

}  // namespace

ClippedPolygon clip(const std::array<ClipVertex, 3>& triangle, const Viewport& viewport) {
  ClippedPolygon polygon;
  for (const ClipVertex& v : triangle) polygon.corners[static_cast<std::size_t>(polygon.count++)] = v;
  for (const PlaneDistance plane : planes) {
    polygon = clip_to(polygon, plane, viewport);
    if (polygon.count < 3) return {};
  }
  return polygon;
}

Vec3f drawn_position(const DrawnCell& cell, VertexId v) {
  const Vec3f own = cell.positions[v];
  return cell.morphing ? blend_positions(cell.lambdas[v], own, cell.coarser_positions[cell.parents[v]]) : own;
}

std::array<ClipVertex, 3> clip_corners(const ViewProjection& projection, const DrawnCell& cell, const VertexIds& v) {
  std::array<ClipVertex, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f p = drawn_position(cell, VertexId(v[k]));
    corners[k] = to_clip(projection, p);
    if (cell.model->clip) corners[k].kept = distance_from(*cell.model->clip, p);
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
