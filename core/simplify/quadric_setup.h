// From triangles to rings, fresh quadrics and first buckets.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simplify/quadric_kernel.h"

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
  const float bound = input_.max_displacement * scale_ * bound_margin;
  squared_bound_ = bound * bound;

  for (unsigned v = 0; v < count_; ++v) {
    const Vec3f& p = input_.positions[v];
    a_.point[v] = {p.x * scale_, p.y * scale_, p.z * scale_, 0};
    a_.triangles[v] = 0;
    a_.member[v] = {none, static_cast<Id>(v)};
    result_.positions[v] = p;
  }
}

template <class L>
void BlockKernel<L>::add_link(std::uint32_t v, std::uint32_t from, std::uint32_t to) {
  const unsigned k = a_.triangles[v];
  if (k < 16) {
    a_.link[v].from[k] = static_cast<Id>(from);
    a_.link[v].to[k] = static_cast<Id>(to);
  }
  a_.triangles[v] = static_cast<std::uint8_t>(k < 17 ? k + 1 : 17);
}

template <class L>
void BlockKernel<L>::link_triangles() {
  live_ = input_.triangles.size();
  for (const Triangle& t : input_.triangles) {
    add_link(t.v[0], t.v[1], t.v[2]);
    add_link(t.v[1], t.v[2], t.v[0]);
    add_link(t.v[2], t.v[0], t.v[1]);
  }
}

// Follows the link of a closed fan of n triangles; 0 where it is none. All successors are looked up first, four bits
// each, so that only shifts wait for one another. Every link edge is met once: a path that met one twice could not come
// back to its start.
template <class L>
inline unsigned BlockKernel<L>::close_ring(Id v, unsigned n, Id* ring) const {
  const Link& link = a_.link[v];
  const Ids from = Ids::load(link.from);
  std::uint64_t successors = 0;
  unsigned missing = 0;
  for (unsigned k = 0; k < n; ++k) {
    const unsigned next = from.find(link.to[k]);
    missing |= next >= n;
    successors |= static_cast<std::uint64_t>(next & 15) << (4 * k);
  }
  if (missing != 0) return 0;
  unsigned at = 0;
  for (unsigned k = 0; k < n; ++k) {
    if (at == 0 && k != 0) return 0;
    ring[k] = link.from[at];
    at = successors >> (4 * at) & 15;
  }
  return at == 0 ? n : 0;
}

// The same for an open fan, which has one neighbour more than triangles.
template <class L>
unsigned BlockKernel<L>::open_ring(Id v, unsigned n, Id* ring) const {
  const Link& link = a_.link[v];
  const Ids from = Ids::load(link.from), to = Ids::load(link.to);
  Id start = link.from[0];
  for (unsigned k = 0; k <= n; ++k) {
    const unsigned last = to.find(start);
    if (last >= n) break;
    start = link.from[last];
  }
  ring[0] = start;
  for (unsigned k = 1; k <= n; ++k) {
    const unsigned next = from.find(ring[k - 1]);
    if (next >= n) return 0;
    ring[k] = link.to[next];
  }
  return from.find(ring[n]) >= n ? n + 1 : 0;
}

// The set of the neighbours; 0 where a ring cannot hold it.
template <class L>
unsigned BlockKernel<L>::pile_ring(Id v, unsigned n, Id* ring) const {
  unsigned size = 0;
  for (unsigned k = 0; k < 2 * n; ++k) {
    const Id x = k < n ? a_.link[v].from[k] : a_.link[v].to[k - n];
    bool known = false;
    for (unsigned i = 0; i < size; ++i) known |= ring[i] == x;
    if (known) continue;
    if (size == ring_capacity) return 0;
    ring[size++] = x;
  }
  return size;
}

// Returns the degree.
template <class L>
unsigned BlockKernel<L>::make_ring(Id v) {
  Ring& ring = a_.ring[v];
  const Ids empty = Ids::all_none();
  empty.store(ring.lane);
  const unsigned n = a_.triangles[v];
  const bool is_locked = input_.locked[v] != 0;
  unsigned flags = flags_base | (is_locked ? locked : movable | queued);
  unsigned size = n >= 3 && n <= ring_capacity ? close_ring(v, n, ring.lane) : 0;
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
    }
  }
  ring.lane[flags_lane] = static_cast<Id>(flags);
  return size;
}

template <class L>
void BlockKernel<L>::start_vertices() {
  for (std::size_t b = 0; b < bucket_count; ++b) a_.bucket[b] = none;
  for (unsigned i = 0; i < count_; ++i) {
    const Id v = static_cast<Id>(i);
    const unsigned n = make_ring(v);
    if (seams_ == nullptr) start_vertex(v, n);
  }
  if (seams_ == nullptr) return;
  seams_->reset(input_, a_);
  for (unsigned i = 0; i < count_; ++i) start_vertex(static_cast<Id>(i), degree(static_cast<Id>(i)));
}

template <class L>
inline void BlockKernel<L>::start_vertex(Id v, unsigned n) {
  if (!a_.ring[v].has(movable)) {
    a_.body[v] = {};
  } else if (n <= 8) {
    start_quadric<1>(v, n);
  } else {
    start_quadric<2>(v, n);
  }
}

// A plane through the edge to a neighbour on a border or seam, perpendicular to the triangle between it and `beside`.
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
  body.weight += weight;
}

template <class L>
void BlockKernel<L>::add_seam_planes(Id v, unsigned n, Body& body) const {
  for (unsigned lanes = seams_->lanes(v, a_.ring[v], n); lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    add_edge_plane(v, lane, lane + 1 < n ? lane + 1 : 0, body);
  }
}

template <class L>
template <int G>
void BlockKernel<L>::start_quadric(Id v, unsigned n) {
  const Star<G> star = load_star<G>(v);
  const Faces<G> f = faces_of<G>(star, n);
  const bool is_open = a_.ring[v].has(open);
  const unsigned faces = (1u << (is_open ? n - 1 : n)) - 1;
  const Float zero = Float::all(0), one = Float::all(1);
  Float terms[8];
  for (int g = 0; g < G; ++g) {
    const unsigned real = (faces >> (8 * g)) & less(zero, f.size[g]);
    const Float length = sqrt(f.size[g]);
    const Float inverse = one / length;
    const auto term = [&](const Float& a, const Float& b) { return select(real, a * b * inverse, zero); };
    const Float now[8]{
        term(f.nx[g], f.nx[g]), term(f.nx[g], f.ny[g]), term(f.nx[g], f.nz[g]),     term(f.ny[g], f.ny[g]),
        term(f.ny[g], f.nz[g]), term(f.nz[g], f.nz[g]), select(real, length, zero), zero};
    for (int k = 0; k < 8; ++k) terms[k] = g == 0 ? now[k] : terms[k] + now[k];
  }
  Body& body = a_.body[v];
  sums(terms, &body.xx);  // xx to weight, and no error yet
  body.bx = body.by = body.bz = 0;
  if (is_open) {
    add_edge_plane(v, 0, 1, body);
    add_edge_plane(v, n - 1, n - 2, body);
  } else if (a_.ring[v].has(seamed)) {
    add_seam_planes(v, n, body);
  }
  const float isotropic = stiffness * body.weight;
  body.xx += isotropic, body.yy += isotropic, body.zz += isotropic;
  publish(body, a_.point[v]);

  const unsigned allowed = is_open ? 1u | 1u << (n - 1) : (1u << n) - 1;
  Float cost[G];
  for (int g = 0; g < G; ++g) cost[g] = quadratic_form(body, star.x[g], star.y[g], star.z[g]);
  float best = std::numeric_limits<float>::infinity();
  for (int g = 0; g < G; ++g) {
    const float low = lowest(select(allowed >> (8 * g), cost[g], Float::all(best)));
    best = low < best ? low : best;
  }
  push(v, bucket_of(body.weight > 0 ? best / body.weight : 0));
}

}  // namespace lodestone::quadric
