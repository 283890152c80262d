// The quadric of a vertex of the input: the planes of its triangles, and walls along borders and seams.
#pragma once

#include "core/base/prefetch.h"
#include "core/progressive/collapse/ring_tests.h"

namespace lodestone::progressive {
inline namespace LODESTONE_LANES {

// Walls are perpendicular to the triangle beside an edge, weighted by the square of the edge times a factor.
inline constexpr float border_wall = 8, seam_wall = 1;

inline void add_wall(CentredQuadric& q, Vec3f edge, Vec3f normal, float factor) {
  const Vec3f across = cross(edge, normal);
  const float size = length(across);
  if (size > 0) q.add_plane(1 / size * across, factor * dot(edge, edge));
}

[[nodiscard]] inline CentredQuadric star_quadric(const RingMesh& mesh, Id v) {
  CentredQuadric q{};
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

// The same in lanes, for a closed fan of at most eight triangles without seams.
[[gnu::always_inline]] inline CentredQuadric closed_star_quadric(const Star<1>& star, unsigned n) {
  const Star<1> next = next_around<1>(star, n);
  const Float8 &ax = star.x[0], &ay = star.y[0], &az = star.z[0], &bx = next.x[0], &by = next.y[0], &bz = next.z[0];
  const Float8 nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx, zero = all8(0);
  const Float8 size = sqrt(nx * nx + ny * ny + nz * nz);
  const unsigned real = bits(zero < size) & ((1u << n) - 1);
  const Float8 per = select(real, all8(0.5f) / size, zero);  // area times the square of 1 / size
  const Float8 area = select(real, all8(0.5f) * size, zero);
  const Float8 px = per * nx, py = per * ny;
  Float8 rows[8]{px * nx, px * ny, px * nz, py * ny, py * nz, per * nz * nz, area, zero};
  transpose(rows);
  CentredQuadric q{};
  store(&q.xx, ((rows[0] + rows[4]) + (rows[1] + rows[5])) + ((rows[2] + rows[6]) + (rows[3] + rows[7])));
  return q;
}

inline void star_quadrics(const RingMesh& rings, std::size_t begin, std::size_t end, CentredQuadric* quadrics) {
  constexpr std::size_t ahead = 6;
  for (std::size_t k = begin; k < end; ++k) {
    const auto v = static_cast<Id>(k);
    const Ring& ring = rings.ring(v);
    for (const Id x : rings.ring(static_cast<Id>(std::min(k + ahead, end - 1))).neighbours())
      prefetch(&rings.points()[x]);
    bool simple = ring.open == 0 && ring.size <= 8 && ring.size > 0;
    if (rings.has_wedges())
      for (std::uint32_t i = 1; i < ring.size; ++i) simple = simple && ring.wedge(i) == ring.wedge(0);
    quadrics[k] =
        simple ? closed_star_quadric(load_star<1>(rings.points(), ring, v), ring.size) : star_quadric(rings, v);
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::progressive
