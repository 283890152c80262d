#include "render/reconstruct/finish/turn_normals.h"

#include <vector>

#include "core/mesh/raw_mesh.h"

namespace lodestone {
namespace {

// Twice the area long.
Vec3d face_normal(const RawMesh& mesh, const Triangle& t) {
  const Vec3d a = mesh.positions[t.v[0]];
  return cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a);
}

// Calls visit(triangle, corner, wedge) for the corners whose normal faces away.
template <class Visit>
void for_backward_corners(const RawMesh& mesh, const std::vector<Vec3d>& faces, const Visit& visit) {
  const std::vector<Triangle>& corners = mesh.wedges.corners.empty() ? mesh.triangles : mesh.wedges.corners;
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (dot(to_double(mesh.wedges.normal[corners[t].v[k]]), faces[t]) < 0) visit(t, k, corners[t].v[k]);
}

void add_wedge(RawMesh& mesh, std::size_t triangle, std::size_t corner, Vec3f normal) {
  RawWedges& w = mesh.wedges;
  if (w.corners.empty()) w.corners = mesh.triangles;
  const std::uint32_t from = w.corners[triangle].v[corner];
  w.corners[triangle].v[corner] = static_cast<std::uint32_t>(w.normal.size());
  w.normal.push_back(normal);
  if (!w.uv.empty()) w.uv.push_back(Vec2f{w.uv[from]});
  if (!w.colour.empty()) w.colour.push_back(Rgba8{w.colour[from]});
}

}  // namespace

std::size_t turn_normals(RawMesh& mesh) {
  if (mesh.wedges.normal.empty()) return 0;
  std::vector<Vec3d> faces;
  faces.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) faces.push_back(face_normal(mesh, t));
  std::vector<bool> turned(mesh.wedges.normal.size(), false);
  std::size_t backward = 0;
  for_backward_corners(mesh, faces, [&](std::size_t, std::size_t, std::uint32_t w) { turned[w] = true, ++backward; });
  if (2 * backward > 3 * mesh.triangles.size()) return 0;

  std::vector<Vec3d> mean(turned.size());
  const std::vector<Triangle>& corners = mesh.wedges.corners.empty() ? mesh.triangles : mesh.wedges.corners;
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (const std::uint32_t w : corners[t].v)
      if (turned[w]) mean[w] = mean[w] + faces[t];
  for (std::size_t w = 0; w < turned.size(); ++w)
    if (turned[w]) mesh.wedges.normal[w] = unit_normal(mean[w]);

  struct Corner {
    std::size_t triangle, corner;
  };
  std::vector<Corner> left;
  for_backward_corners(mesh, faces, [&](std::size_t t, std::size_t k, std::uint32_t) { left.push_back({t, k}); });
  for (const Corner& c : left) add_wedge(mesh, c.triangle, c.corner, unit_normal(faces[c.triangle]));
  return backward;
}

}  // namespace lodestone
