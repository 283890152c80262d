// How far the block's vertices are from the surface that is left, and the answer.
//
// Based on point-triangle distances (ericson2005), of a whole star at once. The distance of a vertex is measured to the
// triangles around its parent, and from there on to neighbouring ones as long as they are nearer: never less than the
// distance from the surface, and nearly always that distance. StarDistance is the slow twin.
#pragma once

#include <cmath>
#include <limits>

#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

// Distances below three quarters of the block's largest so far are not told apart further: any triangle with the foot
// of the vertex inside is good enough for them. Squared.
inline constexpr float idle_share = 0.5625f;

template <class L>
void BlockKernel<L>::measure_distances() {
  float known = 0;
  for (unsigned i = 0; i < count_; ++i) {
    const Id v = static_cast<Id>(i);
    const Ring& ring = a_.ring[v];
    if (ring.has(gone)) continue;
    const unsigned n = degree(v);
    if (ring.has(pile) || n <= 1) {
      measure_members_apart(v, known);
    } else if (n <= 8) {
      measure_members<1>(v, n, known);
    } else {
      measure_members<2>(v, n, known);
    }
  }
}

// Most members have their foot inside one of the triangles around the survivor, close by: those are done at a glance.
template <class L>
template <int G>
void BlockKernel<L>::measure_members(Id v, unsigned n, float& known) {
  if (a_.member[v].next == none && is_unmoved(v)) return settle(v, v, 0);
  const Point& p = a_.point[v];
  const Sides<G> sides = sides_of<G>(v, n);
  for (Id m = v; m != none; m = a_.member[m].next) {
    const Shift q = start_of(m);
    const Shift o{q.x - p.x, q.y - p.y, q.z - p.z};
    float squared = above<G>(sides, o);
    if (!(squared <= known)) squared = walk(around<G>(v, sides, o), q, known);
    if (idle_share * squared > known) known = idle_share * squared;
    settle(m, v, squared);
  }
}

// Of a survivor whose ring is no fan: by its triangles, as far as they are known, and the stars of its neighbours.
template <class L>
void BlockKernel<L>::measure_members_apart(Id v, float& known) {
  const Point& p = a_.point[v];
  for (Id m = v; m != none; m = a_.member[m].next) {
    const Shift q = start_of(m);
    const float x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
    Foot nearest{x * x + y * y + z * z, v, 0};
    nearest = nearer(nearest, around(v, q));
    for (unsigned k = 0; k < degree(v); ++k) nearest = nearer(nearest, around(a_.ring[v].lane[k], q));
    if (nearest.vertex != v || piles_.knows(v)) nearest.squared = walk(nearest, q, known);
    if (idle_share * nearest.squared > known) known = idle_share * nearest.squared;
    settle(m, v, nearest.squared);
  }
}

template <class L>
bool BlockKernel<L>::is_unmoved(Id v) const {
  return result_.positions[v] == input_.positions[v];
}

// Where a vertex was before the kernel began, in block coordinates.
template <class L>
auto BlockKernel<L>::start_of(Id v) const -> Shift {
  const Vec3f& p = input_.positions[v];
  return {p.x * scale_, p.y * scale_, p.z * scale_};
}

template <class L>
void BlockKernel<L>::settle(Id v, Id parent, float squared) {
  result_.parent[v] = parent;
  result_.distance[v] = std::sqrt(squared) / scale_;
}

template <class L>
template <int G>
inline auto BlockKernel<L>::sides_of(Id v, unsigned n) const -> Sides<G> {
  // Made in place: an assignment would copy in halves, and the loads that follow would wait for them.
  Sides<G> s{load_star<G>(v), faces_of<G>(s.star, n), {}, {}, {}, (1u << n) - 1, 0};
  s.real = a_.ring[v].has(open) ? s.spokes >> 1 : s.spokes;
  for (int g = 0; g < G; ++g) {
    const Float &x = s.star.x[g], &y = s.star.y[g], &z = s.star.z[g];
    const Faces<G>& f = s.faces;
    s.side_x[g] = f.ny[g] * z - f.nz[g] * y;
    s.side_y[g] = f.nz[g] * x - f.nx[g] * z;
    s.side_z[g] = f.nx[g] * y - f.ny[g] * x;
  }
  return s;
}

// Triangles that hold the foot of o. The barycentric coordinates, times the squared normal, are o . side_k for the next
// neighbour, and o . turn_k for both neighbours together.
template <class L>
template <int G>
inline unsigned BlockKernel<L>::feet(const Sides<G>& s, int g, const Float& x, const Float& y, const Float& z) {
  const Faces<G>& f = s.faces;
  const Float next = x * s.side_x[g] + y * s.side_y[g] + z * s.side_z[g];
  const Float both = x * f.turn_x[g] + y * f.turn_y[g] + z * f.turn_z[g];
  const Float zero = Float::all(0);
  return (s.real >> (8 * g)) & not_above(zero, next) & not_above(next, both) & not_above(both, f.size[g]) &
         less(zero, f.size[g]);
}

// Least squared height of o, relative to the vertex, above a triangle that holds its foot; infinite where none does.
template <class L>
template <int G>
inline float BlockKernel<L>::above(const Sides<G>& s, Shift o) {
  const Float x = Float::all(o.x), y = Float::all(o.y), z = Float::all(o.z);
  float least = std::numeric_limits<float>::infinity();
  for (int g = 0; g < G; ++g) {
    const unsigned inside = feet<G>(s, g, x, y, z);
    const Float height = x * s.faces.nx[g] + y * s.faces.ny[g] + z * s.faces.nz[g];
    const float low = lowest(select(inside, height * height / s.faces.size[g], Float::all(least)));
    least = low < least ? low : least;
  }
  return least;
}

// Squared distance of o, relative to the vertex, from the segment a + t e, 0 <= t <= 1.
template <class L>
inline auto BlockKernel<L>::from_segment(const Lane3& o, const Lane3& a, const Lane3& e) -> Float {
  const Float zero = Float::all(0), one = Float::all(1);
  const Float x = o.x - a.x, y = o.y - a.y, z = o.z - a.z;
  const Float along = x * e.x + y * e.y + z * e.z, length = e.x * e.x + e.y * e.y + e.z * e.z;
  const Float t = select(less(zero, length), min(max(along / length, zero), one), zero);
  const Float dx = x - t * e.x, dy = y - t * e.y, dz = z - t * e.z;
  return dx * dx + dy * dy + dz * dz;
}

// The nearest point of a star: above a triangle, or on a spoke, or on the rim.
template <class L>
template <int G>
inline auto BlockKernel<L>::around(Id v, const Sides<G>& s, Shift o) const -> Foot {
  const Float infinite = Float::all(std::numeric_limits<float>::infinity());
  const Lane3 at{Float::all(o.x), Float::all(o.y), Float::all(o.z)};
  const Lane3 centre{Float::all(0), Float::all(0), Float::all(0)};
  const unsigned n = static_cast<unsigned>(std::popcount(s.spokes));
  Float nx[G], ny[G], nz[G];
  next_in_ring<G>(s.star.x, n, nx);
  next_in_ring<G>(s.star.y, n, ny);
  next_in_ring<G>(s.star.z, n, nz);
  Foot nearest{std::numeric_limits<float>::infinity(), v, 0};
  for (int g = 0; g < G; ++g) {
    const Faces<G>& f = s.faces;
    const Lane3 spoke{s.star.x[g], s.star.y[g], s.star.z[g]};
    const Lane3 rim{nx[g] - spoke.x, ny[g] - spoke.y, nz[g] - spoke.z};
    const Float height = at.x * f.nx[g] + at.y * f.ny[g] + at.z * f.nz[g];
    const unsigned inside = feet<G>(s, g, at.x, at.y, at.z);
    Float squared = select(s.spokes >> (8 * g), from_segment(at, centre, spoke), infinite);
    squared = min(select(s.real >> (8 * g), from_segment(at, spoke, rim), infinite), squared);
    squared = min(select(inside, height * height / f.size[g], infinite), squared);
    const float low = lowest(squared);
    if (low < nearest.squared) {
      const unsigned lane = static_cast<unsigned>(std::countr_zero(equal(squared, low)));
      nearest = {low, v, lane + 8 * static_cast<unsigned>(g)};
    }
  }
  return nearest;
}

// q in block coordinates. Infinitely far where the ring of the vertex is no fan.
template <class L>
auto BlockKernel<L>::around(Id v, Shift q) const -> Foot {
  const unsigned n = degree(v);
  if (a_.ring[v].has(pile) && piles_.knows(v)) return {piles_.squared_distance(v, {q.x, q.y, q.z}, a_.point), v, 0};
  if (a_.ring[v].has(pile) || n <= 1) return {std::numeric_limits<float>::infinity(), v, 0};
  const Point& p = a_.point[v];
  const Shift o{q.x - p.x, q.y - p.y, q.z - p.z};
  return n <= 8 ? around<1>(v, sides_of<1>(v, n), o) : around<2>(v, sides_of<2>(v, n), o);
}

// From triangle to neighbouring triangle while they are nearer, and no further once one is within `known`. Where the
// way ends it looks one ring wider: a step over a notch in the border of the block. Every step is strictly nearer. A
// pile has no lanes to follow, all its neighbours are looked at.
template <class L>
float BlockKernel<L>::walk(Foot nearest, Shift q, float known) const {
  for (bool wide = false; nearest.squared > known;) {
    const Ring& ring = a_.ring[nearest.vertex];
    wide |= ring.has(pile);
    const unsigned n = degree(nearest.vertex);
    const bool alone = ring.has(pile);
    const Id corners[3]{nearest.vertex, alone ? nearest.vertex : ring.lane[nearest.lane],
                        alone ? nearest.vertex : ring.lane[nearest.lane + 1 < n ? nearest.lane + 1 : 0]};
    Foot now = nearest;
    for (const Id c : corners) {
      now = nearer(now, around(c, q));
      if (!wide) continue;
      const unsigned neighbours = degree(c);
      for (unsigned k = 0; k < neighbours; ++k) now = nearer(now, around(a_.ring[c].lane[k], q));
    }
    if (now.squared < nearest.squared) {
      nearest = now;
      wide = false;
    } else if (wide) {
      break;
    } else {
      wide = true;
    }
  }
  return nearest.squared;
}

}  // namespace lodestone::quadric
