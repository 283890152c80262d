// Distances of the block's vertices from the surface that is left: bounds of them, and nearly always no more.
//
// Based on point-triangle distances (ericson2005), of a whole star at once. The distance of a vertex is measured to the
// triangles around its parent, and from there on to neighbouring ones as long as they are nearer. Single precision finds
// the triangle; the distance from it is then computed in double. Most vertices need neither: their feet are inside a
// triangle, close by, with a margin for rounding. With L the longest edge of a triangle, r a bound of |o| and of all
// edges of the star, and u = 2^-24, rounding moves o . n by less than 16 u r L^2 and the differences of the barycentric
// coordinates of the foot, times the squared normal, by less than 32 u r^2 L^2, however thin the triangle is.
// StarDistance is the slow twin.
#pragma once

#include <cmath>
#include <limits>

#include "core/simplify/quadric/distance_bound.h"
#include "core/simplify/quadric/star.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// Distances below three quarters of the block's largest so far are not told apart further: any triangle that holds the
// foot of the vertex is good enough for them. Squared.
inline constexpr float idle_share = 0.5625f;
// Nor are those below this one, of the extent of the mesh.
inline constexpr float idle_distance = 0x1p-26f;

// A star for distances: side_k . o is the barycentric coordinate of the next neighbour, times the squared normal.
template <int G>
struct Sides {
  Star<G> star;
  Faces<G> faces;
  Float8 side_x[G], side_y[G], side_z[G];
  unsigned spokes, real;  // lanes with a neighbour, lanes with a triangle
};

// The nearest point of a star: in triangle `lane` of the vertex, or on its border.
struct Foot {
  float squared;
  Id vertex;
  unsigned lane;
};
inline Foot nearer(const Foot& a, const Foot& b) { return b.squared < a.squared ? b : a; }

struct Lane3 {
  Float8 x, y, z;
};

// The position of a vertex before the kernel began, in block coordinates.
inline Vec3f start_of(const Block& b, Id v) {
  const Vec3f& p = b.input.positions[v];
  return {p.x * b.scale, p.y * b.scale, p.z * b.scale};
}

inline Vec3f relative(Vec3f q, const AlignedPoint& p) { return {q.x - p.x, q.y - p.y, q.z - p.z}; }

// Rounding of the root included.
inline void write_distance(Block& b, Id v, Id parent, float squared) {
  b.result.parent[v] = parent;
  b.result.distance[v] = std::sqrt(squared) * (1 + 0x1p-22f) / b.scale;
}

template <int G>
[[nodiscard, gnu::always_inline]] inline Sides<G> sides_of(const Block& b, Id v, unsigned n) {
  // Made in place: an assignment would copy in halves, and the loads that follow would wait for them.
  Sides<G> s{load_star<G>(b, v), faces_of<G>(s.star, n), {}, {}, {}, (1u << n) - 1, 0};
  s.real = b.a.ring[v].has(open) ? s.spokes >> 1 : s.spokes;
  for (int g = 0; g < G; ++g) {
    const Float8 &x = s.star.x[g], &y = s.star.y[g], &z = s.star.z[g];
    const Faces<G>& f = s.faces;
    s.side_x[g] = f.ny[g] * z - f.nz[g] * y;
    s.side_y[g] = f.nz[g] * x - f.nx[g] * z;
    s.side_z[g] = f.nx[g] * y - f.ny[g] * x;
  }
  return s;
}

// Triangles of group g that hold the foot of o, at least `margin` inside. The barycentric coordinates, times the squared
// normal, are o . side_k for the next neighbour, and o . turn_k for both neighbours together.
template <int G>
[[nodiscard, gnu::always_inline]] inline unsigned feet(const Sides<G>& s, int g, const Lane3& o, const Float8& margin) {
  const Faces<G>& f = s.faces;
  const Float8 next = o.x * s.side_x[g] + o.y * s.side_y[g] + o.z * s.side_z[g];
  const Float8 both = o.x * f.turn_x[g] + o.y * f.turn_y[g] + o.z * f.turn_z[g];
  const Float8 zero = all8(0);
  return (s.real >> (8 * g)) & bits(margin <= next) & bits(next + margin <= both) & bits(both + margin <= f.size[g]) &
         bits(zero < f.size[g]);
}

// The longest edges of a star's triangles.
template <int G>
struct Longest {
  Float8 squared[G];  // of each triangle
  float reach;        // of all
};

template <int G>
[[nodiscard, gnu::always_inline]] inline Longest<G> longest_of(const Sides<G>& s, unsigned n) {
  Longest<G> longest;
  const Star<G>& star = s.star;
  const Star<G> next = next_around<G>(star, n);
  float most = 0;
  for (int g = 0; g < G; ++g) {
    const Float8 &x = star.x[g], &y = star.y[g], &z = star.z[g];
    const Float8 ex = next.x[g] - x, ey = next.y[g] - y, ez = next.z[g] - z;
    const Float8 here = x * x + y * y + z * z, rim = ex * ex + ey * ey + ez * ez;
    const Float8 there = next.x[g] * next.x[g] + next.y[g] * next.y[g] + next.z[g] * next.z[g];
    longest.squared[g] = select(s.real >> (8 * g), max(max(here, there), rim), all8(0));
    const float high = -lowest(all8(0) - longest.squared[g]);
    most = high > most ? high : most;
  }
  longest.reach = std::sqrt(most);
  return longest;
}

// A bound of the squared distance of o, relative to the vertex, from a triangle that surely holds its foot; infinite if
// none does.
template <int G>
[[nodiscard, gnu::always_inline]] inline float above(const Sides<G>& s, const Longest<G>& longest, Vec3f o) {
  constexpr float height_rounding = 0x1p-20f, place_rounding = 0x1p-19f;
  const Lane3 at{all8(o.x), all8(o.y), all8(o.z)};
  // At least |o| and the reach.
  const float r = longest.reach + (o.x * o.x + o.y * o.y + o.z * o.z) / longest.reach;
  float least = std::numeric_limits<float>::infinity();
  for (int g = 0; g < G; ++g) {
    const unsigned inside = feet<G>(s, g, at, all8(place_rounding * r * r) * longest.squared[g]);
    const Float8 along = at.x * s.faces.nx[g] + at.y * s.faces.ny[g] + at.z * s.faces.nz[g];
    const Float8 height = max(along, all8(0) - along) + all8(height_rounding * r) * longest.squared[g];
    const float low = lowest(select(inside, height * height / s.faces.size[g], all8(least)));
    least = low < least ? low : least;
  }
  return least;
}

// Squared distance of o, relative to the vertex, from the segment a + t e, 0 <= t <= 1.
[[nodiscard, gnu::always_inline]] inline Float8 from_segment(const Lane3& o, const Lane3& a, const Lane3& e) {
  const Float8 zero = all8(0), one = all8(1);
  const Float8 x = o.x - a.x, y = o.y - a.y, z = o.z - a.z;
  const Float8 along = x * e.x + y * e.y + z * e.z, length = e.x * e.x + e.y * e.y + e.z * e.z;
  const Float8 t = select(bits(zero < length), min(max(along / length, zero), one), zero);
  const Float8 dx = x - t * e.x, dy = y - t * e.y, dz = z - t * e.z;
  return dx * dx + dy * dy + dz * dz;
}

// The nearest point of a star: above a triangle, or on a spoke, or on the rim.
template <int G>
[[nodiscard]] inline Foot nearest_in(const Sides<G>& s, Id v, Vec3f o) {
  const Float8 infinite = all8(std::numeric_limits<float>::infinity());
  const Lane3 at{all8(o.x), all8(o.y), all8(o.z)};
  const Lane3 centre{all8(0), all8(0), all8(0)};
  const Star<G> next = next_around<G>(s.star, static_cast<unsigned>(std::popcount(s.spokes)));
  Foot nearest{std::numeric_limits<float>::infinity(), v, 0};
  for (int g = 0; g < G; ++g) {
    const Faces<G>& f = s.faces;
    const Lane3 spoke{s.star.x[g], s.star.y[g], s.star.z[g]};
    const Lane3 rim{next.x[g] - spoke.x, next.y[g] - spoke.y, next.z[g] - spoke.z};
    const Float8 height = at.x * f.nx[g] + at.y * f.ny[g] + at.z * f.nz[g];
    const unsigned inside = feet<G>(s, g, at, all8(0));
    Float8 squared = select(s.spokes >> (8 * g), from_segment(at, centre, spoke), infinite);
    squared = min(select(s.real >> (8 * g), from_segment(at, spoke, rim), infinite), squared);
    squared = min(select(inside, height * height / f.size[g], infinite), squared);
    const float low = lowest(squared);
    if (low < nearest.squared) {
      const unsigned lane = static_cast<unsigned>(std::countr_zero(bits(squared == all8(low))));
      nearest = {low, v, lane + 8 * static_cast<unsigned>(g)};
    }
  }
  return nearest;
}

// The nearest point of the star of v to q, in block coordinates; infinitely far if its triangles are not known.
inline Foot nearest_around(const Block& b, Id v, Vec3f q) {
  const unsigned n = b.degree(v);
  if (b.a.ring[v].has(nonmanifold) && b.stars.contains(v))
    return {b.stars.squared_distance(v, q, b.a.point), v, 0};
  if (b.a.ring[v].has(nonmanifold) || n <= 1) return {std::numeric_limits<float>::infinity(), v, 0};
  const Vec3f o = relative(q, b.a.point[v]);
  return n <= 8 ? nearest_in<1>(sides_of<1>(b, v, n), v, o) : nearest_in<2>(sides_of<2>(b, v, n), v, o);
}

// From triangle to neighbouring triangle while they are nearer, and no further once one is within `known`. Where the
// way ends it looks one ring wider: a step over a notch in the border of the block. Every step is strictly nearer. A
// nonmanifold vertex has no lanes to follow: all its neighbours are looked at.
inline Foot walk(const Block& b, Foot nearest, Vec3f q, float known) {
  for (bool wide = false; nearest.squared > known;) {
    const Ring& ring = b.a.ring[nearest.vertex];
    const unsigned n = b.degree(nearest.vertex);
    const bool alone = ring.has(nonmanifold);
    wide |= alone;
    const Id corners[3]{nearest.vertex, alone ? nearest.vertex : ring.lane[nearest.lane],
                        alone ? nearest.vertex : ring.lane[nearest.lane + 1 < n ? nearest.lane + 1 : 0]};
    Foot now = nearest;
    for (const Id c : corners) {
      now = nearer(now, nearest_around(b, c, q));
      if (!wide) continue;
      const unsigned neighbours = b.degree(c);
      for (unsigned k = 0; k < neighbours; ++k) now = nearer(now, nearest_around(b, b.a.ring[c].lane[k], q));
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
  return nearest;
}

// A bound of the squared distance of q from the triangle with this foot. Without a fan there is no lane: the foot has a
// bound from the beginning.
inline float bound_of(const Block& b, const Foot& foot, Vec3f q) {
  const Ring& ring = b.a.ring[foot.vertex];
  const unsigned n = b.degree(foot.vertex);
  if (ring.has(nonmanifold) || n <= 1) return foot.squared;
  // The last spoke of an open fan has its triangle before it.
  const unsigned k = ring.has(open) && foot.lane + 1 == n ? foot.lane - 1 : foot.lane;
  return squared_distance_bound(q, b.a.point[foot.vertex], b.a.point[ring.lane[k]],
                                b.a.point[ring.lane[k + 1 < n ? k + 1 : 0]]);
}

// Most members have their foot inside one of the triangles around the survivor, close by: those are done at a glance.
template <int G>
inline void measure_members(Block& b, Id v, unsigned n, float& known) {
  if (b.a.member[v].next == none && b.result.positions[v] == b.input.positions[v]) return write_distance(b, v, v, 0);
  const Sides<G> sides = sides_of<G>(b, v, n);
  const Longest<G> longest = longest_of<G>(sides, n);
  for (Id m = v; m != none; m = b.a.member[m].next) {
    const Vec3f q = start_of(b, m), o = relative(q, b.a.point[v]);
    float squared = above<G>(sides, longest, o);
    if (!(squared <= known)) squared = bound_of(b, walk(b, nearest_in<G>(sides, v, o), q, known), q);
    if (idle_share * squared > known) known = idle_share * squared;
    write_distance(b, m, v, squared);
  }
}

// For a survivor whose ring is not a fan: by its triangles, as far as they are known, and the stars of its neighbours.
inline void measure_members_apart(Block& b, Id v, float& known) {
  for (Id m = v; m != none; m = b.a.member[m].next) {
    const Vec3f q = start_of(b, m), o = relative(q, b.a.point[v]);
    Foot nearest{(o.x * o.x + o.y * o.y + o.z * o.z) * (1 + 0x1p-20f), v, 0};
    nearest = nearer(nearest, nearest_around(b, v, q));
    for (unsigned k = 0; k < b.degree(v); ++k) nearest = nearer(nearest, nearest_around(b, b.a.ring[v].lane[k], q));
    if (nearest.vertex != v || b.stars.contains(v)) nearest = walk(b, nearest, q, known);
    const float squared = bound_of(b, nearest, q);
    if (idle_share * squared > known) known = idle_share * squared;
    write_distance(b, m, v, squared);
  }
}

inline void measure_distances(Block& b) {
  float known = idle_distance * b.scale * idle_distance * b.scale;
  for (unsigned i = 0; i < b.count; ++i) {
    const Id v = static_cast<Id>(i);
    const Ring& ring = b.a.ring[v];
    if (ring.has(gone)) continue;
    const unsigned n = b.degree(v);
    if (ring.has(nonmanifold) || n <= 1) {
      measure_members_apart(b, v, known);
    } else if (n <= 8) {
      measure_members<1>(b, v, n, known);
    } else {
      measure_members<2>(b, v, n, known);
    }
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
