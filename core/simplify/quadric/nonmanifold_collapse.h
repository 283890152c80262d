// Collapses of vertices whose star is not a fan.
//
// Based on the link condition for any complex of triangles (dey1999): v may go to its neighbour u when what both have
// as neighbours are the third corners of the triangles at their edge, and no triangle would fall onto another. The
// image is a complex again, of the same Euler characteristic, with no more edges of many triangles than before. A
// border, which has no second side to hold it, is followed along. What comes out as a fan is treated as one from then
// on.
#pragma once

#include "core/simplify/quadric/candidate.h"
#include "core/simplify/quadric/rings.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// The lanes that v may go to as far as borders are concerned: along them. Where several meet or one ends it is kept.
inline unsigned lanes_along_borders(const Block& b, Id v, unsigned n) {
  const unsigned border = b.stars.border_lanes(v, b.a.ring[v], n), ends = static_cast<unsigned>(std::popcount(border));
  return ends == 0 ? (1u << n) - 1 : ends == 2 ? border : 0;
}

// As for a fan, triangle by triangle.
inline bool flips_nonmanifold(const Block& b, Id v, Id u) {
  const Vec3f t = b.a.point[u] - b.a.point[v];
  for (const auto& [from, to] : b.stars.triangles(v)) {
    if (from == u || to == u) continue;
    const Vec3f p = b.a.point[from] - b.a.point[v], e = b.a.point[to] - b.a.point[from];
    const float nx = p.y * e.z - p.z * e.y, ny = p.z * e.x - p.x * e.z, nz = p.x * e.y - p.y * e.x;
    const float size = nx * nx + ny * ny + nz * nz;
    const float loss = t.x * (e.y * nz - e.z * ny) + t.y * (e.z * nx - e.x * nz) + t.z * (e.x * ny - e.y * nx);
    if (size > 0 && !(loss < size)) return true;
  }
  return false;
}

// The number of triangles of v with u and w.
inline unsigned shared_triangles(const Block& b, Id v, Id u, Id w) {
  unsigned count = 0;
  for (const auto& [from, to] : b.stars.triangles(v)) count += (from == u && to == w) || (from == w && to == u);
  return count;
}

// The number of triangles at the edge from u, of any kind, to its neighbour w.
inline unsigned uses(const Block& b, Id u, Id w) {
  if (b.stars.contains(u)) return b.stars.uses(u, w);
  const Id16 ids = Id16::load(b.a.ring[u].lane);
  const unsigned place = ids.find(w);
  return b.a.ring[u].has(open) && (place == 0 || place + 1 == ids.find(none)) ? 1 : 2;
}

inline bool has_triangle(const Block& b, Id u, Id v, Id w) {
  if (b.stars.contains(u)) return b.stars.has_triangle(u, v, w);
  const Id16 ids = Id16::load(b.a.ring[u].lane);
  const unsigned n = ids.find(none), i = ids.find(v), j = ids.find(w);
  if (i >= n || j >= n) return false;
  const unsigned apart = i < j ? j - i : i - j;
  return apart == 1 || (!b.a.ring[u].has(open) && apart == n - 1);
}

inline bool is_nonmanifold_joinable(const Block& b, Id v, Id u) {
  const Ring &ring = b.a.ring[v], &target = b.a.ring[u];
  if (target.has(crowded) || target.has(sealed) || target.has(seamed)) return false;
  const unsigned n = b.degree(v), m = b.degree(u);
  const Id16 target_ids = Id16::load(target.lane);
  unsigned common = 0;
  for (unsigned k = 0; k < n; ++k) {
    const Id w = ring.lane[k];
    if (w == u) continue;
    if (target_ids.find(w) >= m) {
      // The block on the other side could make an edge of locked vertices too.
      if (target.has(locked) && b.a.ring[w].has(locked)) return false;
      continue;
    }
    ++common;
    if (!b.stars.has_triangle(v, u, w)) return false;
    // The edge that both become must still carry a triangle.
    if (b.stars.uses(v, w) + uses(b, u, w) == 2 * shared_triangles(b, v, u, w)) return false;
  }
  if (m + n - 2 - common > ring_capacity) return false;
  for (const auto& [from, to] : b.stars.triangles(v)) {
    if (from == u || to == u) continue;
    if (has_triangle(b, u, from, to)) return false;
    if (target.has(locked) && b.a.ring[from].has(locked) && b.a.ring[to].has(locked)) return false;
  }
  return true;
}

// Lists the triangles of a fan that a nonmanifold vertex is about to collapse into.
inline void begin_nonmanifold(Block& b, Id u) {
  Ring& ring = b.a.ring[u];
  const unsigned n = b.degree(u), triangles = ring.has(open) ? n - 1 : n;
  b.stars.begin(u);
  for (unsigned k = 0; k < triangles; ++k) b.stars.add(u, {ring.lane[k], ring.lane[k + 1 < n ? k + 1 : 0]});
  ring.lane[flags_lane] = static_cast<Id>((ring.lane[flags_lane] & ~open) | nonmanifold);
}

// Gives a vertex its ring back if its triangles have become one fan.
inline void restore_fan(Block& b, Id v) {
  if (!b.stars.contains(v) || b.a.ring[v].has(sealed)) return;
  const auto triangles = b.stars.triangles(v);
  const auto n = static_cast<unsigned>(triangles.size());
  if (n == 0 || n > ring_capacity) return;
  Link& link = b.a.link[v];
  std::copy(triangles.begin(), triangles.end(), link.edge);
  Ring& ring = b.a.ring[v];
  Ring fan;
  Id16::all_none().store(fan.lane);
  unsigned flags = ring.lane[flags_lane] & ~nonmanifold;
  unsigned size = n >= 3 ? close_ring(link, n, fan.lane) : 0;
  if (size == 0) {
    Id16::all_none().store(fan.lane);
    size = n < ring_capacity ? open_ring(link, n, fan.lane) : 0;
    flags |= open;
  }
  if (size == 0) return;
  fan.lane[flags_lane] = static_cast<Id>(flags);
  Id16::load(fan.lane).store(ring.lane);
  b.stars.forget(v);
}

// After v has collapsed into u: the listed triangles that its neighbour w had with v are those with u now.
inline void rename_in_triangles(Block& b, Id w, Id v, Id u) {
  b.stars.remove(w, v, u);
  b.stars.replace(w, v, u);
}

// u becomes nonmanifold too, until the result has been looked at.
inline void collapse_nonmanifold(Block& b, Id v, Id u, unsigned bucket) {
  const Ring ring = b.a.ring[v];
  const unsigned n = b.degree(v);
  if (b.seams != nullptr) b.seams->collapse(v, u, b.a);
  if (!b.stars.contains(u)) begin_nonmanifold(b, u);
  b.requeue(u, bucket);
  Id* const target = b.a.ring[u].lane;
  unsigned m = b.degree(u);
  const unsigned place = Id16::load(target).find(v);
  target[place] = target[--m], target[m] = none;
  b.stars.remove(u, v);
  for (unsigned k = 0; k < n; ++k) {
    const Id w = ring.lane[k];
    if (w == u) continue;
    b.requeue(w, bucket);
    const Id16 ids = Id16::load(b.a.ring[w].lane);
    const unsigned at = ids.find(v);
    const bool common = Id16::load(target).find(w) < m;
    if (!common) target[m++] = w;
    if (b.a.ring[w].has(crowded)) continue;
    (common ? ids.without(at) : ids.replace(v, u)).store(b.a.ring[w].lane);
    if (b.stars.contains(w)) rename_in_triangles(b, w, v, u);
  }
  for (const auto& e : b.stars.triangles(v)) {
    if (e.from == u || e.to == u) {
      --b.live;
    } else {
      b.stars.add(u, e);
    }
  }
  b.a.ring[v].lane[flags_lane] = flags_base | gone;
  merge_bodies(b, v, u, b.a.point[u] - b.a.point[v]);
  for (unsigned k = 0; k < n; ++k) restore_fan(b, ring.lane[k]);
}

// After a fan v, whose ring is given, has collapsed into u: the triangles of the nonmanifold vertices around it.
[[gnu::noinline]] inline void update_nonmanifold(Block& b, Id v, Id u, const Ring& ring) {
  const bool is_open = ring.has(open);
  const unsigned n = Id16::load(ring.lane).find(none), triangles = is_open ? n - 1 : n;
  if (b.stars.contains(u)) {
    b.stars.remove(u, v);
    for (unsigned k = 0; k < triangles; ++k) {
      const Id from = ring.lane[k], to = ring.lane[k + 1 < n ? k + 1 : 0];
      if (from != u && to != u) b.stars.add(u, {from, to});
    }
  }
  for (unsigned k = 0; k < n; ++k)
    if (const Id w = ring.lane[k]; w != u && b.stars.contains(w)) rename_in_triangles(b, w, v, u);
  for (unsigned k = 0; k < n; ++k) restore_fan(b, ring.lane[k]);
}

[[gnu::noinline]] inline void visit_nonmanifold(Block& b, Id v, unsigned bucket) {
  const unsigned n = b.degree(v);
  Candidate<2> c;
  survey(b, v, n, c), rate(b, c);
  c.allowed &= lanes_along_borders(b, v, n);
  for (choose(c); c.lane < 32; choose(c)) {
    if (c.bucket > bucket + patience) return b.push(v, c.bucket);
    if ((c.near >> c.lane & 1) == 0) c.allowed &= c.near = within_bound<2>(b, v, c.star);
    if ((c.allowed >> c.lane & 1) != 0) {
      const Id u = b.a.ring[v].lane[c.lane];
      if (!flips_nonmanifold(b, v, u) && is_nonmanifold_joinable(b, v, u)) return collapse_nonmanifold(b, v, u, bucket);
      c.allowed &= ~(1u << c.lane);
    }
  }
  b.leave_queue(v);
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
