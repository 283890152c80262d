#include "render/reconstruct/finish/lost_parts.h"

#include <algorithm>

#include "core/base/sort_unique.h"
#include "render/reconstruct/finish/label_parts.h"
#include "render/reconstruct/finish/resample_attributes.h"
#include "render/reconstruct/finish/simplify_merged.h"
#include "render/reconstruct/seams/edit_mesh.h"

namespace lodestone {
namespace {

double area_of(const IndexedMesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t.v[0]]);
  return 0.5 * length(cross(to_double(mesh.positions[t.v[1]]) - a, to_double(mesh.positions[t.v[2]]) - a));
}

// Their triangles, ascending.
std::vector<std::uint32_t> find_lost(const IndexedMesh& mesh, double spacing, const std::vector<std::uint32_t>& source,
                                     std::size_t& parts, double& area) {
  const std::vector<std::uint32_t> part = label_parts(mesh, 0);
  if (part.empty()) return {};
  std::vector<double> lost(1 + *std::max_element(part.begin(), part.end()), 0.0);
  for (std::size_t t = 0; t < part.size(); ++t) lost[part[t]] += area_of(mesh, mesh.triangles[t]);
  for (const std::uint32_t t : source)
    if (t != no_source) lost[part[t]] = 0;
  for (double& a : lost) {
    a = a < 0.25 * spacing * spacing ? 0 : a;
    area += a, parts += a > 0;
  }
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < part.size(); ++t)
    if (lost[part[t]] > 0) triangles.push_back(t);
  return triangles;
}

// Removes whole pieces with an edge of one triangle.
void drop_open_pieces(EditMesh& mesh) {
  std::vector<TriangleId> open;
  for (TriangleId t{0}; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3 && mesh.alive(t); ++k)
      if (mesh.is_border(mesh.corners(t)[k], mesh.corners(t)[(k + 1) % 3])) open.push_back(t);
  while (!open.empty()) {
    const TriangleId t = open.back();
    open.pop_back();
    if (!mesh.alive(t)) continue;
    const auto gone = mesh.corners(t);
    mesh.remove(t);
    for (const VertexId v : gone) open.insert(open.end(), mesh.around(v).begin(), mesh.around(v).end());
  }
}

// Vertices of several fans become several vertices.
void split_fans(EditMesh& edit, MergedMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(edit.vertex_count());
  for (VertexId v{0}; v < count; ++v)
    edit.part_fans(v, [&](const std::vector<TriangleId>&) {
      mesh.position.push_back(Vec3f(mesh.position[v]));
      mesh.pixel.push_back(std::uint32_t{mesh.pixel[v]});
      return edit.add_vertex();
    });
}

// The parts as a manifold mesh; `pixel` holds a triangle of each vertex.
MergedMesh take_out(const IndexedMesh& mesh, const std::vector<std::uint32_t>& triangles, bool closed) {
  const auto vertex_of = [&](std::uint32_t w) { return mesh.wedges.vertex.empty() ? w : mesh.wedges.vertex[w]; };
  std::vector<std::uint32_t> used;
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t w : mesh.triangles[t].v) used.push_back(vertex_of(w));
  sort_unique(used);

  MergedMesh result;
  EditMesh edit;
  for (const std::uint32_t v : used) {
    result.position.push_back(mesh.positions[v]);
    (void)edit.add_vertex();
  }
  result.pixel.resize(used.size());
  for (const std::uint32_t t : triangles) {
    VertexId v[3];
    for (std::size_t k = 0; k < 3; ++k)
      v[k] = VertexId(std::lower_bound(used.begin(), used.end(), vertex_of(mesh.triangles[t].v[k])) - used.begin());
    if (edit.add(v[0], v[1], v[2]) == EditMesh::none) continue;
    for (const VertexId corner : v) result.pixel[corner] = t;
  }
  if (closed) drop_open_pieces(edit);
  split_fans(edit, result);
  result.normal.resize(result.position.size());
  result.view.resize(result.position.size(), no_view), result.feature.resize(result.position.size(), 0);
  for (TriangleId t{0}; t < edit.triangle_count(); ++t)
    if (edit.alive(t)) result.triangles.push_back(edit.triangle(t));
  return result;
}

}  // namespace

LostParts take_over_lost_parts(const IndexedMesh& mesh, double spacing, MergedMesh& merged,
                               std::vector<std::uint32_t>& source, bool closed, Scheduler& scheduler) {
  LostParts lost;
  double area = 0;
  const std::vector<std::uint32_t> triangles = find_lost(mesh, spacing, source, lost.parts, area);
  if (triangles.empty()) return lost;
  MergedMesh part = take_out(mesh, triangles, closed);
  SimplifyMergedConfig config;
  config.triangles = std::max(2 * lost.parts, static_cast<std::size_t>(2 * area / (spacing * spacing)));
  config.farthest = static_cast<float>(4 * spacing);
  RawWedges none;
  simplify_merged(part, none, config, scheduler);

  const auto first = static_cast<std::uint32_t>(merged.position.size());
  source.insert(source.end(), part.pixel.begin(), part.pixel.end());
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(merged.position, part.position), append(merged.normal, part.normal), append(merged.view, part.view);
  append(merged.pixel, part.pixel), append(merged.feature, part.feature);
  for (const Triangle& t : part.triangles)
    merged.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  lost.triangles = part.triangles.size();
  return lost;
}

}  // namespace lodestone
