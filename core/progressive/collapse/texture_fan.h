// The texture deviation of cohen1998, in lanes: the maximum distance in space between points of equal texture
// coordinates before and after a collapse. Both surfaces are linear between the crossings of their edges on the
// texture, so the largest distance is at a crossing or at the vertex that goes.
//
// Everything is relative to the vertex, in 32-bit floats; only whether a triangle is turned over is decided exactly.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/math/lanes/float8.h"
#include "core/progressive/collapse/ring_mesh.h"
#include "core/progressive/collapse/uv_star.h"

namespace lodestone::progressive {

// A wedge in space and on the texture, in one load.
struct alignas(32) TexturePoint {
  float x, y, z, u, v;
  float deviation;  // of what has collapsed into the vertex
  float several;    // not zero: the vertex has other wedges, or none
  float unused = 0;

  [[nodiscard]] Vec2f uv() const { return {u, v}; }
};

// The triangles of one wedge of a vertex. Spokes lead to the neighbours, in the order of the ring; where there are
// several fans of triangles, a spoke may be listed twice.
struct TextureFan {
  static constexpr std::uint32_t max_spokes = 64, room = max_spokes + 16;

  Id wedge = no_id;
  std::uint32_t spokes = 0;
  std::uint64_t sectors = 0;  // bit k: spoke k and the one after it have a triangle
  std::uint64_t unsure = 0;   // bit k: a triangle may be turned over if the vertex moves to the end of spoke k
  Id ids[room];               // of the wedges at the ends of spokes
  alignas(32) float u[room], v[room], x[room], y[room], z[room];  // of these wedges, less the vertex
  // With the vertex at the end of the spoke: the distance from the vertex to the point of equal texture coordinates,
  // and the length of the spoke.
  alignas(32) float own[room], length[room];

  [[nodiscard]] std::uint32_t next(std::uint32_t k) const { return k + 1 < spokes ? k + 1 : 0; }
  // The spoke that ends in a wedge; `spokes`, if there is none.
  [[nodiscard]] std::uint32_t find(Id id) const {
    return static_cast<std::uint32_t>(std::find(ids, ids + spokes, id) - ids);
  }
};

inline namespace LODESTONE_LANES {

[[gnu::always_inline]] inline float highest(const Float8& a) { return -lowest(all8(0) - a); }

// Eight spokes; returns which of their ends have other wedges, too. Lanes after the last spoke hold the vertex.
template <class IdAt>
[[gnu::always_inline]] inline unsigned load_spokes(TextureFan& fan, std::uint32_t at, const TexturePoint* points,
                                                   const TexturePoint& from, const IdAt& id_at) {
  Float8 rows[8];
  for (int k = 0; k < 8; ++k) rows[k] = load<Float8>(&points[id_at(at + static_cast<std::uint32_t>(k))].x);
  transpose(rows);
  store(fan.x + at, rows[0] - all8(from.x));
  store(fan.y + at, rows[1] - all8(from.y));
  store(fan.z + at, rows[2] - all8(from.z));
  store(fan.u + at, rows[3] - all8(from.u));
  store(fan.v + at, rows[4] - all8(from.v));
  return bits(all8(0) < rows[6]);
}

// Areas below this may be of either sign: with a reach of r differences have an error of 4 r e, for a rounding e, and
// areas one of 48 r^2 e.
[[nodiscard]] inline float area_margin(const TextureFan& fan) {
  Float8 reach = all8(0);
  for (std::uint32_t at = 0; at < fan.spokes; at += 8) {
    const Float8 u = load<Float8>(fan.u + at), v = load<Float8>(fan.v + at);
    reach = max(reach, max(u * u, v * v));
  }
  return 64 * 0x1p-24f * highest(reach) + 1e-35f;
}

// Moves the vertex to eight spokes at a time, one in each lane, and looks at every triangle. A vertex outside the new
// triangles, along a seam or border that is not straight on the texture, counts with the whole way.
[[gnu::always_inline]] inline void measure(TextureFan& fan) {
  const float margin = area_margin(fan);
  const Float8 zero = all8(0), one = all8(1), least = all8(-1e-5f);
  fan.unsure = 0;
  for (std::uint32_t at = 0; at < fan.spokes; at += 8) {
    const Float8 tu = load<Float8>(fan.u + at), tv = load<Float8>(fan.v + at);
    const Float8 tx = load<Float8>(fan.x + at), ty = load<Float8>(fan.y + at), tz = load<Float8>(fan.z + at);
    Float8 most = zero;
    unsigned found = 0, unsure = 0;
    for (std::uint64_t left = fan.sectors; left != 0; left &= left - 1) {
      const auto a = static_cast<std::uint32_t>(std::countr_zero(left)), b = fan.next(a);
      const float area = fan.u[a] * fan.v[b] - fan.v[a] * fan.u[b];
      const Float8 au = all8(fan.u[a]) - tu, av = all8(fan.v[a]) - tv, bu = all8(fan.u[b]) - tu,
                   bv = all8(fan.v[b]) - tv;
      const Float8 after = au * bv - av * bu, per = one / after;
      const Float8 w = all8(area) * per, wa = (tv * bu - tu * bv) * per, wb = one - w - wa;
      const unsigned inside = bits(least < min(min(w, wa), wb));
      const Float8 x = w * tx + wa * all8(fan.x[a]) + wb * all8(fan.x[b]);
      const Float8 y = w * ty + wa * all8(fan.y[a]) + wb * all8(fan.y[b]);
      const Float8 z = w * tz + wa * all8(fan.z[a]) + wb * all8(fan.z[b]);
      most = max(most, select(inside, x * x + y * y + z * z, zero));
      found |= inside;
      // Triangles with the end of the spoke vanish.
      const unsigned vanish = (a - at < 8 ? 1u << (a - at) : 0) | (b - at < 8 ? 1u << (b - at) : 0);
      const unsigned kept = std::abs(area) > margin ? bits(all8(margin) < all8(std::copysign(1.0f, area)) * after) : 0;
      unsure |= ~(kept | vanish);
    }
    const Float8 square = tx * tx + ty * ty + tz * tz;
    store(fan.own + at, sqrt(select(found, most, square)));
    store(fan.length + at, sqrt(square));
    fan.unsure |= std::uint64_t{unsure & 0xff} << at;
  }
}

inline void load_all_spokes(TextureFan& fan, const TexturePoint* points) {
  for (std::uint32_t at = 0; at < fan.spokes; at += 8)
    (void)load_spokes(fan, at, points, points[fan.wedge], [&](std::uint32_t k) { return fan.ids[k]; });
}

// Puts the wedges of neighbours into the fan of a vertex of one wedge; false if the two triangles at an edge differ.
inline bool find_wedges(TextureFan& fan, std::uint64_t several, const RingMesh& rings, Id v) {
  const Ring& ring = rings.ring(v);
  for (; several != 0; several &= several - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(several));
    const Ring& other = rings.ring(ring.ids[k]);
    const std::uint32_t back = other.find(v);
    const Id after = other.wedge(other.previous(back)), before = other.wedge(back);
    const bool last = ring.open != 0 && k + 1 == ring.size;
    if (after != before && !last && (ring.open == 0 || k > 0)) return false;
    fan.ids[k] = last ? before : after;
  }
  return true;
}

// A vertex of one wedge, off the ends of seams: spoke k leads to neighbour k. False if it is another vertex.
[[gnu::always_inline]] inline bool fill_whole_fan(TextureFan& fan, const TexturePoint* points, const RingMesh& rings,
                                                  Id v) {
  const Ring& ring = rings.ring(v);
  if (points[v].several != 0 || ring.size > TextureFan::max_spokes) return false;
  fan.wedge = v, fan.spokes = ring.size, fan.sectors = ~std::uint64_t{0} >> (64 - ring.sectors());
  std::uint64_t several = 0;
  for (std::uint32_t at = 0; at < ring.size; at += 8) {
    store(fan.ids + at, load<Int8>(ring.ids + at));
    const auto id_at = [&](std::uint32_t k) { return k < ring.size ? ring.ids[k] : v; };
    several |= std::uint64_t{load_spokes(fan, at, points, points[v], id_at)} << at;
  }
  if (several != 0) {
    if (!find_wedges(fan, several, rings, v)) return false;
    for (std::uint32_t k = 0; k < 8; ++k) fan.ids[fan.spokes + k] = v;
    load_all_spokes(fan, points);
  }
  measure(fan);
  return true;
}

// Any vertex; false if there are too many spokes.
inline bool fill_fan(TextureFan& fan, const TexturePoint* points, const RingMesh& rings, Id v, Id wedge) {
  const Ring& ring = rings.ring(v);
  fan.wedge = wedge, fan.spokes = 0, fan.sectors = 0;
  const auto wedge_of = [&](Id x, Id next) { return points[x].several != 0 ? rings.wedge_of(x, next) : x; };
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    if (rings.has_wedges() && ring.wedge(k) != wedge) continue;
    if (fan.spokes + 2 > TextureFan::max_spokes) return false;
    const Id a = ring.ids[k], b = ring.ids[ring.next(k)], first = wedge_of(a, b);
    if (fan.spokes == 0 || fan.ids[fan.spokes - 1] != first) fan.ids[fan.spokes++] = first;
    fan.sectors |= std::uint64_t{1} << (fan.spokes - 1);
    fan.ids[fan.spokes++] = wedge_of(b, v);
  }
  for (std::uint32_t k = 0; k < 8; ++k) fan.ids[fan.spokes + k] = wedge;
  load_all_spokes(fan, points);
  measure(fan);
  return true;
}

// True if a triangle that is kept would be turned over, or flattened, on the texture, with the vertex moved to the end
// of a spoke. Exact.
[[nodiscard]] inline bool turns_texture(const TextureFan& fan, const TexturePoint* points, std::uint32_t to) {
  if ((fan.unsure >> to & 1) == 0) return false;
  const Id gone = fan.ids[to];
  for (std::uint64_t left = fan.sectors; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    const Id a = fan.ids[k], b = fan.ids[fan.next(k)];
    if (a == gone || b == gone) continue;
    const double before = uv_area(points[fan.wedge].uv(), points[a].uv(), points[b].uv());
    const double after = uv_area(points[gone].uv(), points[a].uv(), points[b].uv());
    if ((before > 0 && !(after > 0)) || (before < 0 && !(after < 0))) return true;
  }
  return false;
}

// The largest distance where new edges, to the end of a spoke, cross old ones.
[[nodiscard, gnu::always_inline]] inline float crossing_deviation(const TextureFan& fan, std::uint32_t to) {
  const float tu = fan.u[to], tv = fan.v[to];
  const Float8 tx = all8(fan.x[to]), ty = all8(fan.y[to]), tz = all8(fan.z[to]), zero = all8(0), one = all8(1);
  // New edges along old ones, to the spokes beside this one, cross nothing.
  const std::uint64_t bit = std::uint64_t{1} << to, last = std::uint64_t{1} << (fan.spokes - 1);
  std::uint64_t beside = (fan.sectors & bit) << 1 | (fan.sectors & bit >> 1);
  if ((fan.sectors & last) != 0) beside |= (bit & 1) != 0 ? last : bit == last ? 1 : 0;
  const std::uint64_t apart = ~std::uint64_t{0} >> (64 - fan.spokes) & ~(bit | beside);
  Float8 most = zero;
  for (std::uint32_t at = 0; at < fan.spokes; at += 8) {
    const Float8 mu = load<Float8>(fan.u + at), mv = load<Float8>(fan.v + at);
    const Float8 mx = load<Float8>(fan.x + at), my = load<Float8>(fan.y + at), mz = load<Float8>(fan.z + at);
    const Float8 across = all8(tv) * mu - all8(tu) * mv;
    const unsigned real = fan.spokes - at < 8 ? (1u << (fan.spokes - at)) - 1 : 0xff;
    for (std::uint64_t left = apart; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      const float eu = fan.u[k] - tu, ev = fan.v[k] - tv;
      const Float8 per = one / (all8(eu) * mv - all8(ev) * mu);
      const Float8 s = across * per, t = all8(tv * eu - tu * ev) * per;
      const unsigned of_itself = k - at < 8 ? 1u << (k - at) : 0;
      const unsigned crossed = bits(zero <= min(s, t)) & bits(max(s, t) <= one) & real & ~of_itself;
      const Float8 x = tx + s * (all8(fan.x[k]) - tx) - t * mx, y = ty + s * (all8(fan.y[k]) - ty) - t * my,
                   z = tz + s * (all8(fan.z[k]) - tz) - t * mz;
      most = max(most, select(crossed, x * x + y * y + z * z, zero));
    }
  }
  return highest(sqrt(most));
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::progressive
