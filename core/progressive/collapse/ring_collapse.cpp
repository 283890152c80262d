// Half-edge collapses on rings: the tests of the surface and its charts, and the collapse itself.
//
// Collapsing v into u: let a be after u in the ring of v and b before it; the triangles (v, u, a) and (v, b, u)
// vanish. The ring of u reads ... a, v, b ...; what lies between a and b in the ring of v takes the place of v there.
#include <algorithm>
#include <cstring>

#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {
namespace {

// The place of the neighbour after a in the ring of v, with u at `at`.
std::uint32_t first_between(const Ring& v, std::uint32_t at) { return v.open != 0 && at != 0 ? 0 : v.next(v.next(at)); }

}  // namespace

bool RingMesh::follows_wedges(Collapse& c) const {
  const Ring& v = rings_[c.vertex];
  c.at = v.find(c.target);
  c.back = rings_[c.target].find(c.vertex);
  if (v.open != 0 && c.at != 0 && c.at + 1 != v.size) return false;
  if (has_wedges_) return maps_wedges(c);
  c.wedge[0] = c.wedge[1] = c.vertex;
  c.wedge_target[0] = c.wedge_target[1] = c.target;
  return true;
}

bool RingMesh::has_one_wedge(Id v) const {
  const Ring& ring = rings_[v];
  for (std::uint32_t k = 0; has_wedges_ && k < ring.sectors(); ++k)
    if (ring.wedge(k) != v) return false;
  return ring.size > 0;
}

bool RingMesh::allows(Collapse& c) const {
  const Ring& v = rings_[c.vertex];
  c.at = v.find(c.target);
  c.back = rings_[c.target].find(c.vertex);
  c.wedge[0] = c.wedge[1] = c.vertex;
  c.wedge_target[0] = c.wedge_target[1] = c.target;
  if (v.open != 0 && c.at != 0 && c.at + 1 != v.size) return false;  // borders collapse along borders
  return keeps_surface(c) && (!has_wedges_ || allows_wedges(c));
}

bool RingMesh::allows_wedges(Collapse& c) const { return maps_wedges(c) && keeps_charts(c); }

// The link condition: the only common neighbours are a and b. And u, a and b keep a triangle, or a fan of three.
bool RingMesh::keeps_surface(const Collapse& c) const {
  const Ring &v = rings_[c.vertex], &u = rings_[c.target];
  if (v.open == 0 && v.size < 3) return false;
  std::uint32_t common = 0;
  for (const Id x : v.neighbours())
    for (const Id y : u.neighbours()) common += x == y ? 1 : 0;
  const std::uint32_t sides = v.open != 0 ? 1 : 2;
  if (common != sides) return false;
  const std::uint32_t merged = v.open != 0 ? u.size + v.size - 3 : u.size + v.size - 4;
  if (merged < (u.open != 0 ? 2u : 3u)) return false;
  const auto keeps_fan = [&](std::uint32_t k) {
    const Ring& side = rings_[v.ids[k]];
    return side.size > (side.open != 0 ? 2u : 3u);
  };
  if (v.open == 0) return keeps_fan(v.next(c.at)) && keeps_fan(v.previous(c.at));
  return keeps_fan(c.at == 0 ? 1 : c.at - 1);
}

// The wedges across the edge. Sector `at` of v and sector back - 1 of u are the triangle with a; the sectors before and
// at those the triangle with b.
bool RingMesh::maps_wedges(Collapse& c) const {
  const Ring &v = rings_[c.vertex], &u = rings_[c.target];
  const bool with_a = v.open == 0 || c.at == 0, with_b = v.open == 0 || c.at != 0;
  if (with_a) c.wedge[0] = v.wedge(c.at), c.wedge_target[0] = u.wedge(u.previous(c.back));
  if (with_b) c.wedge[1] = v.wedge(v.previous(c.at)), c.wedge_target[1] = u.wedge(c.back);
  if (!with_a) c.wedge[0] = c.wedge[1], c.wedge_target[0] = c.wedge_target[1];
  if (!with_b) c.wedge[1] = c.wedge[0], c.wedge_target[1] = c.wedge_target[0];
  if (c.wedge[0] == c.wedge[1] && c.wedge_target[0] != c.wedge_target[1]) return false;
  for (std::uint32_t k = 0; k < v.sectors(); ++k)
    if (v.wedge(k) != c.wedge[0] && v.wedge(k) != c.wedge[1]) return false;
  return true;
}

// True if charts, or the surface, end at the edge from v to its neighbour k.
bool RingMesh::is_seam(Id id, std::uint32_t k) const {
  const Ring& v = rings_[id];
  if (v.open != 0 && (k == 0 || k + 1 == v.size)) return true;
  if (v.wedge(k) != v.wedge(v.previous(k))) return true;
  const Ring& x = rings_[v.ids[k]];
  const std::uint32_t back = x.find(id);
  return x.wedge(back) != x.wedge(x.previous(back));
}

// The triangle (v, u, a) may go unless its chart has nothing else between v a and u a; likewise with b.
bool RingMesh::keeps_charts(const Collapse& c) const {
  const Ring &v = rings_[c.vertex], &u = rings_[c.target];
  const auto ends = [&](std::uint32_t k) { return is_seam(c.vertex, k) && is_seam(c.target, u.find(v.ids[k])); };
  if (v.open == 0) return !ends(v.next(c.at)) && !ends(v.previous(c.at));
  return !ends(c.at == 0 ? 1 : c.at - 1);
}

int RingMesh::apply(const Collapse& c, RingArena& arena) {
  const Ring& v = rings_[c.vertex];
  const bool with_a = v.open == 0 || c.at == 0, with_b = v.open == 0 || c.at != 0;
  const Id a = with_a ? v.ids[v.next(c.at)] : no_id, b = with_b ? v.ids[v.previous(c.at)] : no_id;
  // Those between a and b, in order.
  const std::uint32_t between = v.open != 0 ? v.size - 2 : v.size - 3;
  for (std::uint32_t n = 0, k = first_between(v, c.at); n < between; ++n, k = v.next(k)) {
    Ring& ring = rings_[v.ids[k]];
    ring.ids[ring.find(c.vertex)] = c.target;
  }
  splice(c, arena);
  if (with_a) remove(a, c.vertex, c.target);
  if (with_b) remove(b, c.vertex, c.target);
  rings_[c.vertex].size = 0;
  return with_a && with_b ? 2 : 1;
}

// splice within the place of the ring itself: blocks of four, more than needed, since that is cheaper than to count.
// The fields after the ids that they overwrite are restored.
void RingMesh::splice_own(Ring& u, const Ring& v, std::uint32_t back, std::uint32_t first, std::uint32_t between) {
  struct Four {
    Id ids[4];
  };
  const std::uint32_t size = u.size + between - 1, capacity = u.capacity, open = u.open;
  Four tail[3];
  std::memcpy(tail, u.own + back + 1, sizeof tail);
  for (std::uint32_t k = 0, from = first; k < between; ++k, from = v.next(from)) u.own[back + k] = v.ids[from];
  for (std::uint32_t k = 0, to = back + between; to < size; ++k, to += 4)
    std::memcpy(&u.own[to], &tail[k], sizeof(Four));
  u.ids = u.own;
  u.size = size;
  u.capacity = capacity & 0x7fff'ffffu, u.open = open & 1u;
}

// The ring of u with v replaced by what lies between a and b: from a on, sector by sector, up to before b.
void RingMesh::splice(const Collapse& c, RingArena& arena) {
  const Ring& v = rings_[c.vertex];
  Ring& u = rings_[c.target];
  const bool at_end = v.open != 0;
  const std::uint32_t between = at_end ? v.size - 2 : v.size - 3;
  grow(u, u.size + between - 1, arena);
  Id* ids = u.ids;
  const std::uint32_t back = c.back, first = first_between(v, c.at);
  if (ids == u.own && !has_wedges_) return splice_own(u, v, back, first, between);
  const auto move_up = [&](Id* row) {  // the ids after v, to their new place
    std::memmove(row + back + between, row + back + 1, (u.size - back - 1) * sizeof(Id));
  };
  move_up(ids);
  if (has_wedges_) move_up(ids + u.capacity);
  for (std::uint32_t k = 0, from = first; k < between; ++k, from = v.next(from)) ids[back + k] = v.ids[from];
  u.size = u.size + between - 1;
  if (!has_wedges_) return;
  const auto mapped = [&](std::uint32_t k) { return c.wedge_target[v.wedge(k) == c.wedge[0] ? 0 : 1]; };
  // Sectors: that of a, in the place before v, then those of the inserted neighbours.
  if (!at_end || c.at == 0) {
    if (v.sectors() > 1) u.wedge(back > 0 ? back - 1 : u.size - 1) = mapped(v.next(c.at));
  }
  for (std::uint32_t k = 0, from = first; k < between; ++k, from = v.next(from))
    if (from < v.sectors()) u.wedge(back + k) = mapped(from);
}

void RingMesh::grow(Ring& ring, std::uint32_t size, RingArena& arena) const {
  if (size <= ring.capacity) return;
  const std::uint32_t capacity = std::max(size, size + size / 2);
  Id* ids = arena.take(std::size_t{capacity} * (has_wedges_ ? 2 : 1));
  std::copy_n(ring.ids, ring.size, ids);
  if (has_wedges_) std::copy_n(ring.ids + ring.capacity, ring.size, ids + capacity);
  ring.ids = ids;
  ring.capacity = capacity & 0x7fff'ffffu;
}

// Removes `gone` from the ring of a or b. The triangle with both goes; the one beyond `gone` takes its place.
void RingMesh::remove(Id from, Id gone, Id stays) {
  Ring& ring = rings_[from];
  const std::uint32_t at = ring.find(gone);
  if (has_wedges_) {
    if (ring.ids[ring.previous(at)] == stays && !(ring.open != 0 && at == 0))
      ring.wedge(ring.previous(at)) = ring.wedge(at);
    Id* wedges = &ring.wedge(0);
    std::copy(wedges + at + 1, wedges + ring.size, wedges + at);
  }
  if (ring.size <= 8 && ring.ids == ring.own) {  // within the twelve: four, and four more where there may be some
    Id behind[8];
    std::memcpy(behind, ring.own + at + 1, sizeof behind);
    std::memcpy(ring.own + at, behind, sizeof behind / 2);
    if (at <= 4) std::memcpy(ring.own + at + 4, behind + 4, sizeof behind / 2);
  } else {
    std::copy(ring.ids + at + 1, ring.ids + ring.size, ring.ids + at);
  }
  ring.size = ring.size - 1;
}

void RingMesh::insert(Ring& ring, std::uint32_t at, Id id, RingArena& arena) const {
  grow(ring, ring.size + 1, arena);
  std::memmove(ring.ids + at + 1, ring.ids + at, (ring.size - at) * sizeof(Id));
  ring.ids[at] = id;
  ring.size = ring.size + 1;
}

void RingMesh::undo(Id vertex, Id target, std::uint32_t size, RingArena& arena) {
  Ring &v = rings_[vertex], &u = rings_[target];
  v.size = size;
  const std::uint32_t at = v.find(target);
  const Id a = v.ids[v.next(at)], b = v.ids[v.previous(at)];
  for (const Id x : v.neighbours()) {
    if (x == target || x == a || x == b) continue;
    Ring& ring = rings_[x];
    ring.ids[ring.find(target)] = vertex;
  }
  // In the ring of u the neighbours after a and before b give way to v; they may go on at its beginning.
  const std::uint32_t between = size - 3, first = u.next(u.find(a));
  if (between == 0) {
    insert(u, first, vertex, arena);
  } else {
    const std::uint32_t last = std::min(first + between, u.size), wrapped = first + between - last;
    u.ids[first] = vertex;
    std::copy(u.ids + last, u.ids + u.size, u.ids + first + 1);
    u.size = u.size - (last - first - 1);
    std::copy(u.ids + wrapped, u.ids + u.size, u.ids);
    u.size = u.size - wrapped;
  }
  Ring &before = rings_[a], &after = rings_[b];
  insert(before, before.find(target), vertex, arena);
  insert(after, after.find(target) + 1, vertex, arena);
}

}  // namespace lodestone::progressive
