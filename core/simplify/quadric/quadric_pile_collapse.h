// Collapses of vertices whose star is no fan.
//
// Based on the link condition for any complex of triangles (dey1999): v may go to its neighbour u when what both have
// as neighbours are the third corners of the triangles at their edge, and no triangle would fall onto another. The
// image is a complex again, of the same Euler characteristic, with no more edges of many triangles than before. A
// border, which has no second side to hold it, is followed along. What comes out as a fan is treated as one from then
// on.
#pragma once

#include <algorithm>
#include <bit>

#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

template <class L>
void BlockKernel<L>::visit_pile(Id v, unsigned bucket) {
  const unsigned n = degree(v);
  Candidate<2> c;
  survey(v, n, c), rate(c);
  c.allowed &= pile_lanes(v, n);
  for (choose(c); c.lane < 32; choose(c)) {
    if (c.bucket > bucket + patience) return push(v, c.bucket);
    if ((c.near >> c.lane & 1) == 0) c.allowed &= c.near = within_bound<2>(v, c.star);
    if ((c.allowed >> c.lane & 1) != 0) {
      const Id u = a_.ring[v].lane[c.lane];
      if (!pile_flips(v, u) && pile_joinable(v, u)) return collapse_pile(v, u, bucket);
      c.allowed &= ~(1u << c.lane);
    }
  }
  a_.ring[v].lane[flags_lane] = static_cast<Id>(a_.ring[v].lane[flags_lane] & ~queued);
}

// Where it may go as far as borders are concerned: along them. Where several meet or one ends it stays.
template <class L>
unsigned BlockKernel<L>::pile_lanes(Id v, unsigned n) const {
  const unsigned border = border_lanes(v, n), ends = static_cast<unsigned>(std::popcount(border));
  return ends == 0 ? (1u << n) - 1 : ends == 2 ? border : 0;
}

template <class L>
unsigned BlockKernel<L>::border_lanes(Id v, unsigned n) const {
  unsigned bits = 0;
  for (unsigned k = 0; k < n; ++k)
    if (piles_.is_border(v, a_.ring[v].lane[k])) bits |= 1u << k;
  return bits;
}

// As for a fan, triangle by triangle.
template <class L>
bool BlockKernel<L>::pile_flips(Id v, Id u) const {
  const Point &p = a_.point[v], &q = a_.point[u];
  const Shift t{q.x - p.x, q.y - p.y, q.z - p.z};
  for (const auto& [from, to] : piles_.triangles(v)) {
    if (from == u || to == u) continue;
    const Point &a = a_.point[from], &b = a_.point[to];
    const float x = a.x - p.x, y = a.y - p.y, z = a.z - p.z;
    const float ex = b.x - a.x, ey = b.y - a.y, ez = b.z - a.z;
    const float nx = y * ez - z * ey, ny = z * ex - x * ez, nz = x * ey - y * ex;
    const float size = nx * nx + ny * ny + nz * nz;
    const float loss = t.x * (ey * nz - ez * ny) + t.y * (ez * nx - ex * nz) + t.z * (ex * ny - ey * nx);
    if (size > 0 && !(loss < size)) return true;
  }
  return false;
}

template <class L>
bool BlockKernel<L>::pile_joinable(Id v, Id u) const {
  const Ring &ring = a_.ring[v], &target = a_.ring[u];
  if (target.has(bare) || target.has(sealed) || target.has(seamed)) return false;
  const unsigned n = degree(v), m = degree(u);
  const Ids target_ids = Ids::load(target.lane);
  unsigned common = 0;
  for (unsigned k = 0; k < n; ++k) {
    const Id w = ring.lane[k];
    if (w == u) continue;
    if (target_ids.find(w) >= m) {
      if (target.has(locked) && a_.ring[w].has(locked)) return false;  // the block on the other side could make it too
      continue;
    }
    ++common;
    if (!piles_.has_triangle(v, u, w)) return false;
    // The edge that both become must still carry a triangle.
    if (piles_.uses(v, w) + uses(u, w) == 2 * shared_triangles(v, u, w)) return false;
  }
  if (m + n - 2 - common > ring_capacity) return false;
  for (const auto& [a, b] : piles_.triangles(v)) {
    if (a == u || b == u) continue;
    if (has_triangle(u, a, b)) return false;
    if (target.has(locked) && a_.ring[a].has(locked) && a_.ring[b].has(locked)) return false;
  }
  return true;
}

// Triangles of v with u and w.
template <class L>
unsigned BlockKernel<L>::shared_triangles(Id v, Id u, Id w) const {
  unsigned count = 0;
  for (const auto& [a, b] : piles_.triangles(v)) count += (a == u && b == w) || (a == w && b == u);
  return count;
}

// Triangles at the edge from u, pile or not, to its neighbour w.
template <class L>
unsigned BlockKernel<L>::uses(Id u, Id w) const {
  if (piles_.knows(u)) return piles_.uses(u, w);
  const Ids ids = Ids::load(a_.ring[u].lane);
  const unsigned place = ids.find(w);
  return a_.ring[u].has(open) && (place == 0 || place + 1 == ids.find(none)) ? 1 : 2;
}

template <class L>
bool BlockKernel<L>::has_triangle(Id u, Id a, Id b) const {
  if (piles_.knows(u)) return piles_.has_triangle(u, a, b);
  const Ids ids = Ids::load(a_.ring[u].lane);
  const unsigned n = ids.find(none), i = ids.find(a), j = ids.find(b);
  if (i >= n || j >= n) return false;
  const unsigned apart = i < j ? j - i : i - j;
  return apart == 1 || (!a_.ring[u].has(open) && apart == n - 1);
}

// Planes that hold the borders between its triangles.
template <class L>
void BlockKernel<L>::add_pile_planes(Id v, unsigned n, Body& body) const {
  const Ids ids = Ids::load(a_.ring[v].lane);
  for (unsigned lanes = border_lanes(v, n); lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    const Id w = a_.ring[v].lane[lane];
    for (const auto& [a, b] : piles_.triangles(v))
      if (a == w || b == w) add_edge_plane(v, lane, ids.find(a == w ? b : a), body);
  }
}

// u becomes a pile too, until what has come out is looked at.
template <class L>
void BlockKernel<L>::collapse_pile(Id v, Id u, unsigned bucket) {
  const Ring ring = a_.ring[v];
  const unsigned n = degree(v);
  const Point &p = a_.point[v], &q = a_.point[u];
  if (seams_ != nullptr) seams_->collapse(v, u, a_);
  if (!piles_.knows(u)) begin_pile(u);
  requeue(u, bucket);
  Id* const target = a_.ring[u].lane;
  unsigned m = degree(u);
  const unsigned place = Ids::load(target).find(v);
  target[place] = target[--m], target[m] = none;
  piles_.remove(u, v);
  for (unsigned k = 0; k < n; ++k) {
    const Id w = ring.lane[k];
    if (w == u) continue;
    requeue(w, bucket);
    const Ids ids = Ids::load(a_.ring[w].lane);
    const unsigned at = ids.find(v);
    const bool common = Ids::load(target).find(w) < m;
    if (!common) target[m++] = w;
    if (a_.ring[w].has(bare)) continue;
    (common ? ids.without(at) : ids.replace(v, u)).store(a_.ring[w].lane);
    if (!piles_.knows(w)) continue;
    piles_.remove(w, v, u);
    piles_.replace(w, v, u);
  }
  for (const auto& e : piles_.triangles(v)) {
    if (e.from == u || e.to == u) {
      --live_;
    } else {
      piles_.add(u, e);
    }
  }
  a_.ring[v].lane[flags_lane] = flags_base | gone;
  merge_bodies(v, u, {q.x - p.x, q.y - p.y, q.z - p.z});
  for (unsigned k = 0; k < n; ++k) heal(ring.lane[k]);
}

// A fan that another kind of star is about to collapse into.
template <class L>
void BlockKernel<L>::begin_pile(Id u) {
  Ring& ring = a_.ring[u];
  const unsigned n = degree(u), triangles = ring.has(open) ? n - 1 : n;
  piles_.begin(u);
  for (unsigned k = 0; k < triangles; ++k) piles_.add(u, {ring.lane[k], ring.lane[k + 1 < n ? k + 1 : 0]});
  ring.lane[flags_lane] = static_cast<Id>((ring.lane[flags_lane] & ~open) | pile);
}

// After a fan v has collapsed into u: what the piles around it had with v they have with u now.
template <class L>
void BlockKernel<L>::follow_piles(Id v, Id u, const Ring& ring) {
  const bool is_open = ring.has(open);
  const unsigned n = Ids::load(ring.lane).find(none), triangles = is_open ? n - 1 : n;
  if (piles_.knows(u)) {
    piles_.remove(u, v);
    for (unsigned k = 0; k < triangles; ++k) {
      const Id a = ring.lane[k], b = ring.lane[k + 1 < n ? k + 1 : 0];
      if (a != u && b != u) piles_.add(u, {a, b});
    }
  }
  for (unsigned k = 0; k < n; ++k) {
    const Id w = ring.lane[k];
    if (w == u || !piles_.knows(w)) continue;
    piles_.remove(w, v, u);
    piles_.replace(w, v, u);
  }
  for (unsigned k = 0; k < n; ++k) heal(ring.lane[k]);
}

// A pile whose triangles have come to be one fan is none any more.
template <class L>
void BlockKernel<L>::heal(Id v) {
  if (!piles_.knows(v) || a_.ring[v].has(sealed)) return;
  const auto triangles = piles_.triangles(v);
  const auto n = static_cast<unsigned>(triangles.size());
  if (n == 0 || n > ring_capacity) return;
  std::copy(triangles.begin(), triangles.end(), a_.link[v].edge);
  Ring& ring = a_.ring[v];
  Ring fan;
  Ids::all_none().store(fan.lane);
  unsigned flags = ring.lane[flags_lane] & ~pile;
  unsigned size = n >= 3 ? close_ring(v, n, fan.lane) : 0;
  if (size == 0) {
    Ids::all_none().store(fan.lane);
    size = n < ring_capacity ? open_ring(v, n, fan.lane) : 0;
    flags |= open;
  }
  if (size == 0) return;
  fan.lane[flags_lane] = static_cast<Id>(flags);
  Ids::load(fan.lane).store(ring.lane);
  piles_.forget(v);
}

}  // namespace lodestone::quadric
