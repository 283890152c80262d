// From triangles to rings, fresh quadrics and first buckets.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simplify/quadric/rings.h"
#include "core/simplify/quadric/star.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// Added to every quadric: weight * this * squared distance to where the vertex started. Flat and cylindrical parts get
// a minimum, and short edges go first where nothing else decides. Ten times more would outweigh the error itself on
// models of flat faces, ten times less would be lost in rounding.
inline constexpr float stiffness = 1e-6f;
// Weight of the planes that hold borders of the surface and seams, relative to that of its triangles.
inline constexpr float border_weight = 8;
// Applied to the displacement bound: single precision must not promise what double precision would refuse.
inline constexpr float bound_margin = 1 - 1e-5f;

// Scaled by a power of two so that the bound, or the block where that is smaller, is about 1: no product of lengths
// comes near the ends of the number range, whatever the unit of the input.
inline void place_points(Block& b) {
  float lo[3], hi[3];
  std::fill(lo, lo + 3, std::numeric_limits<float>::max());
  std::fill(hi, hi + 3, -std::numeric_limits<float>::max());
  for (const Vec3f& p : b.input.positions) {
    lo[0] = p.x < lo[0] ? p.x : lo[0], hi[0] = p.x > hi[0] ? p.x : hi[0];
    lo[1] = p.y < lo[1] ? p.y : lo[1], hi[1] = p.y > hi[1] ? p.y : hi[1];
    lo[2] = p.z < lo[2] ? p.z : lo[2], hi[2] = p.z > hi[2] ? p.z : hi[2];
  }
  float size = b.input.max_displacement;
  float extent = 0;
  for (int k = 0; k < 3; ++k) extent = hi[k] - lo[k] > extent ? hi[k] - lo[k] : extent;
  if (extent > 0 && extent < size) size = extent;
  int exponent = 0;
  if (size > 0 && size <= std::numeric_limits<float>::max()) (void)std::frexp(size, &exponent);
  exponent = exponent < -100 ? -100 : exponent > 100 ? 100 : exponent;
  b.scale = std::ldexp(1.0f, -exponent);
  b.bound = b.input.max_displacement * b.scale * bound_margin;
  b.squared_bound = b.bound * b.bound;

  for (unsigned v = 0; v < b.count; ++v) {
    const Vec3f& p = b.input.positions[v];
    b.a.point[v] = {p.x * b.scale, p.y * b.scale, p.z * b.scale, 0};
    b.a.body[v] = {};
    b.a.triangles[v] = 0;
    b.a.member[v] = {none, static_cast<Id>(v)};
    b.result.positions[v] = p;
  }
}

// The plane of a triangle is the same quadric at each of its corners: there it has neither a linear term nor an error.
[[gnu::always_inline]] inline void add_planes(Block& b, const Id (&corner)[3][8]) {
  const Points8 p = gather(b.a.point, corner[0]), q = gather(b.a.point, corner[1]), r = gather(b.a.point, corner[2]);
  const Float8 ex = q.x - p.x, ey = q.y - p.y, ez = q.z - p.z, fx = r.x - p.x, fy = r.y - p.y, fz = r.z - p.z;
  const Float8 nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
  const Float8 size = nx * nx + ny * ny + nz * nz, zero = all8(0);
  const unsigned real = bits(zero < size);
  const auto masked = [&](const Float8& x) { return select(real, x, zero); };
  const Float8 length = masked(sqrt(size)), inverse = masked(all8(1) / length);
  const Float8 x = masked(nx), y = masked(ny), z = masked(nz);
  const Float8 ux = x * inverse, uy = y * inverse, uz = z * inverse;
  Float8 plane[8]{ux * x, ux * y, ux * z, uy * y, uy * z, uz * z, length, zero};  // xx to weight, and no error
  transpose(plane);
  for (int k = 0; k < 8; ++k)
    for (int i = 0; i < 3; ++i) {
      float* sum = &b.a.body[corner[i][k]].xx;
      store(sum, load<Float8>(sum) + plane[k]);
    }
}

// Eight triangles at a time; those that fill up the last eight have no corners and no area.
inline void link_triangles(Block& b) {
  const auto add_link = [&](std::uint32_t v, std::uint32_t from, std::uint32_t to) {
    const std::uint32_t k = b.a.triangles[v]++;
    if (k < 16) b.a.link[v].edge[k] = {static_cast<Id>(from), static_cast<Id>(to)};
  };
  b.live = b.input.triangles.size();
  for (std::size_t first = 0; first < b.live; first += 8) {
    const std::size_t count = std::min<std::size_t>(8, b.live - first);
    Id corner[3][8];
    for (Id(&lanes)[8] : corner) std::ranges::fill(lanes, none);
    for (std::size_t k = 0; k < count; ++k) {
      const Triangle& t = b.input.triangles[first + k];
      for (int i = 0; i < 3; ++i) {
        corner[i][k] = static_cast<Id>(t.v[i]);
        add_link(t.v[i], t.v[(i + 1) % 3], t.v[(i + 2) % 3]);
      }
    }
    add_planes(b, corner);
  }
}

// A plane through the edge to a neighbour on a border or seam, perpendicular to the triangle between it and `beside`.
// It is left out of the weight, which costs are divided by: there it would make the ends of a border cheaper than its
// surface.
inline void add_edge_plane(Block& b, Id v, unsigned lane, unsigned beside) {
  const Id* ring = b.a.ring[v].lane;
  const Vec3f e = b.a.point[ring[lane]] - b.a.point[v], f = b.a.point[ring[beside]] - b.a.point[v];
  const float nx = e.y * f.z - e.z * f.y, ny = e.z * f.x - e.x * f.z, nz = e.x * f.y - e.y * f.x;
  const float wx = e.y * nz - e.z * ny, wy = e.z * nx - e.x * nz, wz = e.x * ny - e.y * nx;
  const float squared = wx * wx + wy * wy + wz * wz;
  if (!(squared > 0)) return;
  const float weight = border_weight * (e.x * e.x + e.y * e.y + e.z * e.z);
  const float s = weight / squared;
  Body& body = b.a.body[v];
  body.xx += s * wx * wx, body.xy += s * wx * wy, body.xz += s * wx * wz;
  body.yy += s * wy * wy, body.yz += s * wy * wz, body.zz += s * wz * wz;
}

inline void add_seam_planes(Block& b, Id v, unsigned n) {
  for (unsigned lanes = b.seams->lanes(v, b.a.ring[v], n); lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    add_edge_plane(b, v, lane, lane + 1 < n ? lane + 1 : 0);
  }
}

// Planes that hold the borders between the triangles of a nonmanifold vertex.
inline void add_nonmanifold_planes(Block& b, Id v, unsigned n) {
  const Id16 ids = Id16::load(b.a.ring[v].lane);
  for (unsigned lanes = b.stars.border_lanes(v, b.a.ring[v], n); lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    const Id w = b.a.ring[v].lane[lane];
    for (const auto& [from, to] : b.stars.triangles(v))
      if (from == w || to == w) add_edge_plane(b, v, lane, ids.find(from == w ? to : from));
  }
}

[[gnu::always_inline]] inline void start_quadric(Block& b, Id v) {
  Body& body = b.a.body[v];
  const Ring& ring = b.a.ring[v];
  if (!ring.has(movable)) {
    body = {};
    return;
  }
  b.movable_fans += !ring.has(nonmanifold);
  if (const unsigned n = b.degree(v); ring.has(nonmanifold)) {
    add_nonmanifold_planes(b, v, n);
    b.movable_corners += b.stars.triangles(v).size();
  } else if (ring.has(open)) {
    add_edge_plane(b, v, 0, 1);
    add_edge_plane(b, v, n - 1, n - 2);
  } else if (ring.has(seamed)) {
    add_seam_planes(b, v, n);
  }
  const float isotropic = stiffness * body.weight;
  body.xx += isotropic, body.yy += isotropic, body.zz += isotropic;
}

// Errors at the neighbours that v may go to, infinite in the other lanes.
template <int G>
[[nodiscard, gnu::always_inline]] inline Float8 first_errors(const Block& b, Id v, unsigned n) {
  const Star<G> star = load_star<G>(b, v);
  const unsigned allowed = b.a.ring[v].has(open) ? 1u | 1u << (n - 1) : (1u << n) - 1;
  Float8 least = all8(std::numeric_limits<float>::infinity());
  for (int g = 0; g < G; ++g)
    least = select(allowed >> (8 * g), min(quadratic_form(b.a.body[v], star.x[g], star.y[g], star.z[g]), least), least);
  return least;
}

// Queues eight vertices, from `first` on: one lane each once the costs of their neighbours are transposed.
inline void push_eight(Block& b, unsigned first) {
  const unsigned count = std::min(8u, b.count - first);
  Float8 least[8];
  float error[8];
  std::int64_t scale[8];
  for (unsigned k = 0; k < 8; ++k) {
    const Id v = static_cast<Id>(first + (k < count ? k : 0));
    const unsigned n = b.degree(v);
    least[k] = n <= 8 ? first_errors<1>(b, v, n) : first_errors<2>(b, v, n);
    scale[k] = scale_of(b.a.body[v].weight);
  }
  transpose(least);
  for (int k = 1; k < 8; ++k) least[0] = min(least[0], least[k]);
  store(error, least[0]);
  for (unsigned k = 0; k < count; ++k) {
    const Id v = static_cast<Id>(first + k);
    b.push(v, b.a.ring[v].has(movable) ? bucket_of(error[k], scale[k]) : nowhere);
  }
}

// Rings, quadrics and first costs are long chains of operations, one after another: a loop each keeps more vertices
// under way at once.
inline void start_vertices(Block& b) {
  for (unsigned v = 0; v < b.count; ++v) make_ring(b, static_cast<Id>(v));
  if (b.seams != nullptr) b.seams->reset(b.input, b.a);
  b.stars.reset(b.input, b.a, b.stars_move);
  for (unsigned v = 0; v < b.count; ++v) start_quadric(b, static_cast<Id>(v));
  std::fill(b.a.bucket, b.a.bucket + bucket_count, none);
  for (unsigned v = 0; v < b.count; v += 8) push_eight(b, v);
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
