// From triangles to rings, fresh quadrics and first buckets.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

// Scaled by a power of two so that the bound, or the block where that is smaller, is about 1: no product of lengths
// comes near the ends of the number range, whatever the unit of the input.
template <class L>
void BlockKernel<L>::place_points() {
  float lo[3], hi[3];
  std::fill(lo, lo + 3, std::numeric_limits<float>::max());
  std::fill(hi, hi + 3, -std::numeric_limits<float>::max());
  for (const Vec3f& p : input_.positions) {
    lo[0] = p.x < lo[0] ? p.x : lo[0], hi[0] = p.x > hi[0] ? p.x : hi[0];
    lo[1] = p.y < lo[1] ? p.y : lo[1], hi[1] = p.y > hi[1] ? p.y : hi[1];
    lo[2] = p.z < lo[2] ? p.z : lo[2], hi[2] = p.z > hi[2] ? p.z : hi[2];
  }
  float size = input_.max_displacement;
  float extent = 0;
  for (int k = 0; k < 3; ++k) extent = hi[k] - lo[k] > extent ? hi[k] - lo[k] : extent;
  if (extent > 0 && extent < size) size = extent;
  int exponent = 0;
  if (size > 0 && size <= std::numeric_limits<float>::max()) (void)std::frexp(size, &exponent);
  exponent = exponent < -100 ? -100 : exponent > 100 ? 100 : exponent;
  scale_ = std::ldexp(1.0f, -exponent);
  bound_ = input_.max_displacement * scale_ * bound_margin;
  squared_bound_ = bound_ * bound_;

  for (unsigned v = 0; v < count_; ++v) {
    const Vec3f& p = input_.positions[v];
    a_.point[v] = {p.x * scale_, p.y * scale_, p.z * scale_, 0};
    a_.body[v] = {};
    a_.triangles[v] = 0;
    a_.member[v] = {none, static_cast<Id>(v)};
    result_.positions[v] = p;
  }
}

template <class L>
inline void BlockKernel<L>::add_link(std::uint32_t v, std::uint32_t from, std::uint32_t to) {
  const std::uint32_t k = a_.triangles[v]++;
  if (k < 16) a_.link[v].edge[k] = {static_cast<Id>(from), static_cast<Id>(to)};
}

// Eight triangles at a time; those that fill up the last eight have no corners and no area.
template <class L>
void BlockKernel<L>::link_triangles() {
  live_ = input_.triangles.size();
  for (std::size_t first = 0; first < live_; first += 8) {
    const std::size_t count = std::min<std::size_t>(8, live_ - first);
    Id corner[3][8];
    std::fill(corner[0], corner[0] + 24, none);
    for (std::size_t k = 0; k < count; ++k) {
      const Triangle& t = input_.triangles[first + k];
      for (int i = 0; i < 3; ++i) {
        corner[i][k] = static_cast<Id>(t.v[i]);
        add_link(t.v[i], t.v[(i + 1) % 3], t.v[(i + 2) % 3]);
      }
    }
    add_planes(corner);
  }
}

// The plane of a triangle is the same quadric at each of its corners: there it has neither a linear term nor an error.
template <class L>
inline void BlockKernel<L>::add_planes(const Id (&corner)[3][8]) {
  const Points a = Points::gather(a_.point, corner[0]), b = Points::gather(a_.point, corner[1]),
               c = Points::gather(a_.point, corner[2]);
  const Float ex = b.x - a.x, ey = b.y - a.y, ez = b.z - a.z, fx = c.x - a.x, fy = c.y - a.y, fz = c.z - a.z;
  const Float nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
  const Float size = nx * nx + ny * ny + nz * nz, zero = Float::all(0);
  const unsigned real = less(zero, size);
  const auto masked = [&](const Float& x) { return select(real, x, zero); };
  const Float length = masked(sqrt(size)), inverse = masked(Float::all(1) / length);
  const Float x = masked(nx), y = masked(ny), z = masked(nz);
  const Float ux = x * inverse, uy = y * inverse, uz = z * inverse;
  Float plane[8]{ux * x, ux * y, ux * z, uy * y, uy * z, uz * z, length, zero};  // xx to weight, and no error
  transpose(plane);
  for (int k = 0; k < 8; ++k)
    for (int i = 0; i < 3; ++i) {
      float* sum = &a_.body[corner[i][k]].xx;
      (Float::load(sum) + plane[k]).store(sum);
    }
}

// The ends of the edges of a link, for searching.
template <class L>
auto BlockKernel<L>::starts_of(const Link& link) -> Ids {
  Id ids[16];
  for (int k = 0; k < 16; ++k) ids[k] = link.edge[k].from;
  return Ids::load(ids);
}

template <class L>
auto BlockKernel<L>::ends_of(const Link& link) -> Ids {
  Id ids[16];
  for (int k = 0; k < 16; ++k) ids[k] = link.edge[k].to;
  return Ids::load(ids);
}

// Follows the link of a closed fan of n triangles; 0 where it is none. Every link edge is met once: a path that met one
// twice could not come back to its start.
template <class L>
unsigned BlockKernel<L>::close_ring(Id v, unsigned n, Id* ring) const {
  const Link& link = a_.link[v];
  const Ids from = starts_of(link);
  unsigned at = 0;
  for (unsigned k = 0; k < n; ++k) {
    if (at == 0 && k != 0) return 0;
    ring[k] = link.edge[at].from;
    at = from.find(link.edge[at].to);
    if (at >= n) return 0;
  }
  return at == 0 ? n : 0;
}

// The same for an open fan, which has one neighbour more than triangles.
template <class L>
unsigned BlockKernel<L>::open_ring(Id v, unsigned n, Id* ring) const {
  const Link& link = a_.link[v];
  const Ids from = starts_of(link), to = ends_of(link);
  Id start = link.edge[0].from;
  for (unsigned k = 0; k <= n; ++k) {
    const unsigned last = to.find(start);
    if (last >= n) break;
    start = link.edge[last].from;
  }
  ring[0] = start;
  for (unsigned k = 1; k <= n; ++k) {
    const unsigned next = from.find(ring[k - 1]);
    if (next >= n) return 0;
    ring[k] = link.edge[next].to;
  }
  return from.find(ring[n]) >= n ? n + 1 : 0;
}

// The set of the neighbours; 0 where a ring cannot hold it.
template <class L>
unsigned BlockKernel<L>::pile_ring(Id v, unsigned n, Id* ring) const {
  unsigned size = 0;
  for (unsigned k = 0; k < 2 * n; ++k) {
    const Id x = k < n ? a_.link[v].edge[k].from : a_.link[v].edge[k - n].to;
    bool known = false;
    for (unsigned i = 0; i < size; ++i) known |= ring[i] == x;
    if (known) continue;
    if (size == ring_capacity) return 0;
    ring[size++] = x;
  }
  return size;
}

template <class L>
inline void BlockKernel<L>::make_ring(Id v) {
  Ring& ring = a_.ring[v];
  const unsigned n = a_.triangles[v];
  if (n >= 3 && n <= 8 && Ids::closed_fan(a_.link[v], n, ring.lane)) {
    ring.lane[flags_lane] = input_.locked[v] != 0 ? flags_base | locked : flags_base | movable | queued;
  } else {
    make_other_ring(v, n);
  }
}

// Crowded, open, not manifold or without triangles.
template <class L>
void BlockKernel<L>::make_other_ring(Id v, unsigned n) {
  Ring& ring = a_.ring[v];
  const Ids empty = Ids::all_none();
  const bool is_locked = input_.locked[v] != 0;
  unsigned flags = flags_base | (is_locked ? locked : movable | queued);
  empty.store(ring.lane);
  unsigned size = n > 8 && n <= ring_capacity ? close_ring(v, n, ring.lane) : 0;
  if (size == 0 && n > 0) {
    empty.store(ring.lane);
    flags |= open;
    size = n < ring_capacity ? open_ring(v, n, ring.lane) : 0;
  }
  if (size == 0) {
    empty.store(ring.lane);
    flags = flags_base | (is_locked ? locked : 0) | pile;
    size = n > 0 && n <= 16 ? pile_ring(v, n, ring.lane) : 0;
    if (size == 0) {
      empty.store(ring.lane);
      flags |= bare;
    } else if (!is_locked) {
      flags |= movable | queued;
      piles_move_ = true;
    }
  }
  ring.lane[flags_lane] = static_cast<Id>(flags);
}

// Rings, quadrics and first costs are long chains of operations, one after another: a loop each keeps more vertices
// under way at once.
template <class L>
void BlockKernel<L>::start_vertices() {
  for (unsigned v = 0; v < count_; ++v) make_ring(static_cast<Id>(v));
  if (seams_ != nullptr) seams_->reset(input_, a_);
  piles_.reset(input_, a_, piles_move_);
  for (unsigned v = 0; v < count_; ++v) start_quadric(static_cast<Id>(v));
  std::fill(a_.bucket, a_.bucket + bucket_count, none);
  for (unsigned v = 0; v < count_; v += 8) push_eight(v);
}

// A plane through the edge to a neighbour on a border or seam, perpendicular to the triangle between it and `beside`.
// Out of the weight, which costs are divided by: there it would make the ends of a border cheaper than its surface.
template <class L>
void BlockKernel<L>::add_edge_plane(Id v, unsigned lane, unsigned beside, Body& body) const {
  const Id* ring = a_.ring[v].lane;
  const Point& p = a_.point[v];
  const Point &a = a_.point[ring[lane]], &b = a_.point[ring[beside]];
  const float ex = a.x - p.x, ey = a.y - p.y, ez = a.z - p.z;
  const float fx = b.x - p.x, fy = b.y - p.y, fz = b.z - p.z;
  const float nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
  const float wx = ey * nz - ez * ny, wy = ez * nx - ex * nz, wz = ex * ny - ey * nx;
  const float squared = wx * wx + wy * wy + wz * wz;
  if (!(squared > 0)) return;
  const float weight = border_weight * (ex * ex + ey * ey + ez * ez);
  const float s = weight / squared;
  body.xx += s * wx * wx, body.xy += s * wx * wy, body.xz += s * wx * wz;
  body.yy += s * wy * wy, body.yz += s * wy * wz, body.zz += s * wz * wz;
}

template <class L>
void BlockKernel<L>::add_seam_planes(Id v, unsigned n, Body& body) const {
  for (unsigned lanes = seams_->lanes(v, a_.ring[v], n); lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    add_edge_plane(v, lane, lane + 1 < n ? lane + 1 : 0, body);
  }
}

template <class L>
inline void BlockKernel<L>::start_quadric(Id v) {
  Body& body = a_.body[v];
  if (!a_.ring[v].has(movable)) {
    body = {};
    return;
  }
  movable_ += !a_.ring[v].has(pile);
  if (const unsigned n = degree(v); a_.ring[v].has(pile)) {
    add_pile_planes(v, n, body);
    pile_corners_ += piles_.triangles(v).size();
  } else if (a_.ring[v].has(open)) {
    add_edge_plane(v, 0, 1, body);
    add_edge_plane(v, n - 1, n - 2, body);
  } else if (a_.ring[v].has(seamed)) {
    add_seam_planes(v, n, body);
  }
  const float isotropic = stiffness * body.weight;
  body.xx += isotropic, body.yy += isotropic, body.zz += isotropic;
}

// Queues eight vertices, from `first` on: one lane each once the costs of their neighbours are transposed.
template <class L>
void BlockKernel<L>::push_eight(unsigned first) {
  const unsigned count = std::min(8u, count_ - first);
  Float least[8];
  float error[8];
  std::int64_t scale[8];
  for (unsigned k = 0; k < 8; ++k) {
    const Id v = static_cast<Id>(first + (k < count ? k : 0));
    const unsigned n = degree(v);
    least[k] = n <= 8 ? first_errors<1>(v, n) : first_errors<2>(v, n);
    scale[k] = scale_of(a_.body[v].weight);
  }
  transpose(least);
  for (int k = 1; k < 8; ++k) least[0] = min(least[0], least[k]);
  least[0].store(error);
  for (unsigned k = 0; k < count; ++k) {
    const Id v = static_cast<Id>(first + k);
    push(v, a_.ring[v].has(movable) ? bucket_of(error[k], scale[k]) : nowhere);
  }
}

// Errors at the neighbours that v may go to, infinite in the other lanes.
template <class L>
template <int G>
inline auto BlockKernel<L>::first_errors(Id v, unsigned n) const -> Float {
  const Star<G> star = load_star<G>(v);
  const unsigned allowed = a_.ring[v].has(open) ? 1u | 1u << (n - 1) : (1u << n) - 1;
  Float least = Float::all(std::numeric_limits<float>::infinity());
  for (int g = 0; g < G; ++g)
    least = select(allowed >> (8 * g), min(quadratic_form(a_.body[v], star.x[g], star.y[g], star.z[g]), least), least);
  return least;
}

}  // namespace lodestone::quadric
