// Eight floats and one ring in plain C++: the twin of lanes_avx2.h, operation by operation.
//
// Both give the same bits: every operation is one IEEE rounding per lane, and minima follow the rule of the instruction
// set (the second operand where either is not a number).
#pragma once

#include <bit>
#include <cstdint>
#include <utility>

#include "core/simplify/quadric/quadric_block.h"

namespace lodestone::quadric::plain {

struct Float8 {
  float lane[8];

  static Float8 all(float s) { return {{s, s, s, s, s, s, s, s}}; }
  static Float8 load(const float* from) {
    return each([&](int k) { return from[k]; });
  }
  void store(float* to) const {
    for (int k = 0; k < 8; ++k) to[k] = lane[k];
  }
  template <class F>
  static Float8 each(F f) {
    Float8 r;
    for (int k = 0; k < 8; ++k) r.lane[k] = f(k);
    return r;
  }
  friend Float8 operator+(const Float8& a, const Float8& b) {
    return each([&](int k) { return a.lane[k] + b.lane[k]; });
  }
  friend Float8 operator-(const Float8& a, const Float8& b) {
    return each([&](int k) { return a.lane[k] - b.lane[k]; });
  }
  friend Float8 operator*(const Float8& a, const Float8& b) {
    return each([&](int k) { return a.lane[k] * b.lane[k]; });
  }
  friend Float8 operator/(const Float8& a, const Float8& b) {
    return each([&](int k) { return a.lane[k] / b.lane[k]; });
  }
};

inline float lower(float a, float b) { return a < b ? a : b; }
inline Float8 sqrt(const Float8& a) {
  return Float8::each([&](int k) { return __builtin_sqrtf(a.lane[k]); });
}
inline Float8 max(const Float8& a, const Float8& b) {
  return Float8::each([&](int k) { return a.lane[k] > b.lane[k] ? a.lane[k] : b.lane[k]; });
}
inline Float8 min(const Float8& a, const Float8& b) {
  return Float8::each([&](int k) { return lower(a.lane[k], b.lane[k]); });
}

// Bit k of a mask is lane k; comparisons with something that is no number are false.
inline unsigned less(const Float8& a, const Float8& b) {
  unsigned bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<unsigned>(a.lane[k] < b.lane[k]) << k;
  return bits;
}
inline unsigned not_above(const Float8& a, const Float8& b) {
  unsigned bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<unsigned>(a.lane[k] <= b.lane[k]) << k;
  return bits;
}
inline Float8 select(unsigned bits, const Float8& yes, const Float8& no) {
  return Float8::each([&](int k) { return (bits >> k & 1) != 0 ? yes.lane[k] : no.lane[k]; });
}
inline Float8 spread(const Float8& a, unsigned lane) { return Float8::all(a.lane[lane]); }
// Lane k+1 in lane k for a ring of n <= 8 lanes: lane 0 in lane n-1. The lanes behind keep theirs.
inline Float8 rotate(const Float8& a, unsigned n) {
  return Float8::each([&](int k) {
    return a.lane[k + 1 < static_cast<int>(n) ? k + 1 : k + 1 == static_cast<int>(n) ? 0 : k];
  });
}
inline float pick(const Float8& a, unsigned lane) { return a.lane[lane]; }

inline float lowest(const Float8& a) {
  float half[4];
  for (int k = 0; k < 4; ++k) half[k] = lower(a.lane[k], a.lane[k + 4]);
  return lower(lower(half[0], half[2]), lower(half[1], half[3]));
}
// Lanes that equal the value.
inline unsigned equal(const Float8& a, float value) {
  unsigned bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<unsigned>(a.lane[k] == value) << k;
  return bits;
}
// Lane i of rows[k] and lane k of rows[i] change places.
inline void transpose(Float8 (&rows)[8]) {
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < i; ++k) std::swap(rows[i].lane[k], rows[k].lane[i]);
}

// Eight points, one lane each.
struct Point8 {
  Float8 x, y, z;
  template <class Ids>
  static Point8 gather(const Point* points, const Ids* ids) {
    Point8 r;
    for (int k = 0; k < 8; ++k) {
      const Point& p = points[ids[k]];
      r.x.lane[k] = p.x, r.y.lane[k] = p.y, r.z.lane[k] = p.z;
    }
    return r;
  }
};

// The lanes of a ring.
struct Id16 {
  Id lane[16];

  static Id16 load(const Id* ids) {
    Id16 r;
    for (int k = 0; k < 16; ++k) r.lane[k] = ids[k];
    return r;
  }
  static Id16 all_none() {
    Id16 r;
    for (Id& id : r.lane) id = none;
    return r;
  }
  void store(Id* ids) const {
    for (int k = 0; k < 16; ++k) ids[k] = lane[k];
  }
  // First lane that equals the id; 16 where none does.
  [[nodiscard]] unsigned find(Id id) const {
    unsigned k = 0;
    while (k < 16 && lane[k] != id) ++k;
    return k;
  }
  [[nodiscard]] bool same(const Id16& other) const {
    unsigned k = 0;
    while (k < 16 && lane[k] == other.lane[k]) ++k;
    return k == 16;
  }
  [[nodiscard]] Id16 replace(Id from, Id to) const {
    Id16 r;
    for (int k = 0; k < 16; ++k) r.lane[k] = lane[k] == from ? to : lane[k];
    return r;
  }
  // The ring without lane `at`; the neighbours behind it move up, the flags stay.
  [[nodiscard]] Id16 without(unsigned at) const {
    Id16 r = *this;
    for (unsigned k = at; k < ring_capacity; ++k) r.lane[k] = lane[k + 1];
    return r;
  }
  // The ring with lane `at` replaced by `length` others; the flags stay.
  static Id16 spliced(const Ring& ring, unsigned at, const Id* others, unsigned length) {
    Id16 r;
    for (unsigned k = 0; k < ring_capacity; ++k)
      r.lane[k] = k < at ? ring.lane[k] : k < at + length ? others[k - at] : ring.lane[k + 1 - length];
    r.lane[flags_lane - 1] = none;
    r.lane[flags_lane] = ring.lane[flags_lane];
    return r;
  }
  // Follows the link of a closed fan of 3 to 8 triangles. False where it is none; what is written means nothing then.
  static bool closed_fan(const Link& link, unsigned n, Id* ring) {
    for (unsigned k = 0; k < 16; ++k) ring[k] = none;
    unsigned at = 0;
    for (unsigned k = 0; k < n; ++k) {
      if (at == 0 && k != 0) return false;
      ring[k] = link.edge[at].from;
      unsigned next = 0;
      while (next < n && link.edge[next].from != link.edge[at].to) ++next;
      if (next == n) return false;
      at = next;
    }
    return at == 0;
  }
  // How many of the first n lanes are among the first m of the other; no lane occurs twice.
  [[nodiscard]] unsigned count_common(unsigned n, const Id16& other, unsigned m) const {
    unsigned common = 0;
    for (unsigned k = 0; k < n; ++k) common += other.find(lane[k]) < m;
    return common;
  }
};

struct Lanes {
  using Float = Float8;
  using Points = Point8;
  using Ids = Id16;
};

}  // namespace lodestone::quadric::plain
