#include "experiments/metrics/geometry/level_on_texture.h"

#include <algorithm>
#include <limits>

#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

constexpr float rounding = 1e-6f;  // of texture coordinates and barycentric ones
constexpr double none = std::numeric_limits<double>::infinity();

std::vector<BoxTree::Item> items(const ProgressiveMesh& mesh, std::span<const Triangle> triangles) {
  std::vector<BoxTree::Item> out(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const Vec3d corner : corners_on_texture(mesh, triangles[t])) out[t].box.extend(to_float(corner));
    out[t].number = t;
  }
  return out;
}

}  // namespace

Vec3d on_texture(const ProgressiveMesh& mesh, VertexId vertex) {
  const Vec2f uv = mesh.wedges.uv[vertex];
  return {uv.x, uv.y, mesh.wedges.material.empty() ? 0.0 : static_cast<double>(mesh.wedges.material[vertex])};
}

std::array<Vec3d, 3> corners_on_texture(const ProgressiveMesh& mesh, const Triangle& t) {
  std::array<Vec3d, 3> corners{on_texture(mesh, VertexId(t.v[0])), on_texture(mesh, VertexId(t.v[1])),
                               on_texture(mesh, VertexId(t.v[2]))};
  corners[1].z = corners[2].z = corners[0].z;  // the first corner has the triangle's material
  return corners;
}

LevelOnTexture::LevelOnTexture(const ProgressiveMesh& mesh, std::span<const Triangle> triangles)
    : mesh_(mesh), triangles_(triangles), tree_(items(mesh, triangles), 4) {}

double LevelOnTexture::distance(Vec3d from, Vec3d q) const {
  double best = none;
  const auto near = [&](const Box3f& box) { return squared_distance(q, box) <= double{rounding} * rounding; };
  tree_.walk(near, [&](BoxTree::Slots slots) {
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
      best = std::min(best, distance(from, q, triangles_[tree_.items()[slot]]));
    return false;
  });
  return best;
}

double LevelOnTexture::distance(Vec3d from, Vec3d q, const Triangle& t) const {
  const auto [a, b, c] = corners_on_texture(mesh_, t);
  if (a.z != q.z || !(squared_length(cross(b - a, c - a)) > 0)) return none;
  const std::array<double, 3> w = barycentric(q, a, b, c);
  if (!(std::min({w[0], w[1], w[2]}) >= -rounding)) return none;
  const auto place = [&](std::size_t k) { return w[k] * to_double(mesh_.positions[t.v[k]]); };
  return length(from - (place(0) + place(1) + place(2)));
}

}  // namespace lodestone
