// The quadric of a vertex of the input: the planes of its triangles, and walls along borders and seams.
#pragma once

#include "core/progressive/collapse/plane_quadric.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

// Walls stand upright on the triangle beside an edge, weighted by the square of the edge times a factor.
inline constexpr float border_wall = 8, seam_wall = 1;

inline void add_wall(PlaneQuadric& q, Vec3f edge, Vec3f normal, float factor) {
  const Vec3f across = cross(edge, normal);
  const float size = length(across);
  if (size > 0) q.add_plane(1 / size * across, factor * dot(edge, edge));
}

[[nodiscard]] inline PlaneQuadric star_quadric(const RingMesh& mesh, Id v) {
  PlaneQuadric q{};
  const Ring& ring = mesh.ring(v);
  const Vec3f centre = mesh.position(v);
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    const Vec3f to = mesh.position(ring.ids[k]) - centre, on = mesh.position(ring.ids[ring.next(k)]) - centre;
    const Vec3f normal = cross(to, on);
    const float size = length(normal);
    q.weight += size / 2;
    if (size > 0) q.add_plane(1 / size * normal, size / 2);
    const bool first = ring.open != 0 && k == 0, last = ring.open != 0 && k + 1 == ring.sectors();
    if (first) add_wall(q, to, normal, border_wall);
    if (last) add_wall(q, on, normal, border_wall);
    if (!first && mesh.has_wedges() && ring.wedge(k) != ring.wedge(ring.previous(k)))
      add_wall(q, to, normal, seam_wall);
  }
  return q;
}

}  // namespace lodestone::progressive
