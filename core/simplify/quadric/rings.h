// From the triangles around a vertex to its ring.
#pragma once

#include "core/simplify/quadric/block.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// The starts of the edges of a link, or their ends, for searching.
inline Id16 ids_of(const Link& link, Id Link::Edge::*end) {
  Id ids[16];
  for (int k = 0; k < 16; ++k) ids[k] = link.edge[k].*end;
  return Id16::load(ids);
}

// Follows the link of a closed fan of n triangles; 0 if it is not one. Every link edge is met once: a path that met one
// twice could not come back to its start.
inline unsigned close_ring(const Link& link, unsigned n, Id* ring) {
  const Id16 from = ids_of(link, &Link::Edge::from);
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
inline unsigned open_ring(const Link& link, unsigned n, Id* ring) {
  const Id16 from = ids_of(link, &Link::Edge::from), to = ids_of(link, &Link::Edge::to);
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

// The set of the neighbours; 0 if a ring cannot hold it.
inline unsigned collect_neighbours(const Link& link, unsigned n, Id* ring) {
  unsigned size = 0;
  for (unsigned k = 0; k < 2 * n; ++k) {
    const Id x = k < n ? link.edge[k].from : link.edge[k - n].to;
    if (std::find(ring, ring + size, x) != ring + size) continue;
    if (size == ring_capacity) return 0;
    ring[size++] = x;
  }
  return size;
}

// Crowded, open, nonmanifold or without triangles.
[[gnu::noinline]] inline void make_other_ring(Block& b, Id v, unsigned n) {
  Ring& ring = b.a.ring[v];
  const Id16 empty = Id16::all_none();
  const bool is_locked = b.input.locked[v] != 0;
  unsigned flags = flags_base | (is_locked ? locked : movable | queued);
  empty.store(ring.lane);
  unsigned size = n > 8 && n <= ring_capacity ? close_ring(b.a.link[v], n, ring.lane) : 0;
  if (size == 0 && n > 0) {
    empty.store(ring.lane);
    flags |= open;
    size = n < ring_capacity ? open_ring(b.a.link[v], n, ring.lane) : 0;
  }
  if (size == 0) {
    empty.store(ring.lane);
    flags = flags_base | (is_locked ? locked : 0) | nonmanifold;
    size = n > 0 && n <= 16 ? collect_neighbours(b.a.link[v], n, ring.lane) : 0;
    if (size == 0) {
      empty.store(ring.lane);
      flags |= crowded;
    } else if (!is_locked) {
      flags |= movable | queued;
      b.stars_move = true;
    }
  }
  ring.lane[flags_lane] = static_cast<Id>(flags);
}

[[gnu::always_inline]] inline void make_ring(Block& b, Id v) {
  Ring& ring = b.a.ring[v];
  const unsigned n = b.a.triangles[v];
  if (n >= 3 && n <= 8 && Id16::closed_fan(b.a.link[v], n, ring.lane)) {
    ring.lane[flags_lane] = b.input.locked[v] != 0 ? flags_base | locked : flags_base | movable | queued;
  } else {
    make_other_ring(b, v, n);
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
