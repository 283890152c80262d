// Eight floats at a time. Every operation is one IEEE rounding per lane, and minima follow the rule of the
// instructions (the second operand where either is not a number), so that every build gives the same bits.
//
// A file that includes this may be compiled for several instruction sets, each in a namespace of its own. Eight floats
// are one register with AVX2 and two registers without; bit k of a mask stands for lane k.
#pragma once

#include <cstdint>
#include <cstring>
#include <utility>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "core/base/instruction_set.h"
#include "core/math/lanes/aligned_point.h"
#include "core/math/lanes/float4.h"

namespace lodestone {

inline namespace LODESTONE_LANES {

inline Float4 sqrt(Float4 a) {
#if defined(__SSE2__)
  return _mm_sqrt_ps(a);
#else
  for (int k = 0; k < 4; ++k) a[k] = __builtin_sqrtf(a[k]);
  return a;
#endif
}
inline unsigned bits(Int4 mask) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  unsigned r = 0;
  for (int k = 0; k < 4; ++k) r |= static_cast<unsigned>(mask[k] < 0) << k;
  return r;
#endif
}

// The lane after each one of a ring of n <= 8 lanes; the lanes after the ring are their own successors.
alignas(32) inline constexpr int next_in_ring[9][8]{
    {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {1, 0, 2, 3, 4, 5, 6, 7},
    {1, 2, 0, 3, 4, 5, 6, 7}, {1, 2, 3, 0, 4, 5, 6, 7}, {1, 2, 3, 4, 0, 5, 6, 7},
    {1, 2, 3, 4, 5, 0, 6, 7}, {1, 2, 3, 4, 5, 6, 0, 7}, {1, 2, 3, 4, 5, 6, 7, 0}};

#if defined(__AVX2__)

using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

inline Float8 all8(float v) { return v - Float8{}; }
inline Int8 ints8(std::int32_t v) { return v + Int8{}; }
inline Int8 select(Int8 mask, Int8 yes, Int8 no) { return mask ? yes : no; }
inline Float8 select(Int8 mask, Float8 yes, Float8 no) { return mask ? yes : no; }
inline Float8 min(Float8 a, Float8 b) { return _mm256_min_ps(a, b); }
inline Float8 max(Float8 a, Float8 b) { return _mm256_max_ps(a, b); }
inline Int8 min(Int8 a, Int8 b) { return a < b ? a : b; }
inline Int8 max(Int8 a, Int8 b) { return a > b ? a : b; }
inline Float8 abs(Float8 a) { return reinterpret_cast<Float8>(reinterpret_cast<Int8>(a) & 0x7fff'ffff); }
inline Float8 sqrt(Float8 a) { return _mm256_sqrt_ps(a); }
inline unsigned bits(Int8 mask) { return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask))); }
inline Float8 select(unsigned bits, Float8 yes, Float8 no) {
#if defined(LODESTONE_AVX512)
  return _mm256_mask_blend_ps(static_cast<__mmask8>(bits), no, yes);
#else
  const Int8 lane_bit{1, 2, 4, 8, 16, 32, 64, 128};
  return ((static_cast<std::int32_t>(bits) + Int8{}) & lane_bit) == lane_bit ? yes : no;
#endif
}
inline Float8 spread(Float8 a, unsigned lane) {
  return _mm256_permutevar8x32_ps(a, _mm256_set1_epi32(static_cast<int>(lane)));
}
inline float pick(Float8 a, unsigned lane) { return _mm256_cvtss_f32(spread(a, lane)); }
inline Float8 rotate(Float8 a, unsigned n) {
  return _mm256_permutevar8x32_ps(a, _mm256_load_si256(reinterpret_cast<const __m256i*>(next_in_ring[n])));
}
inline Float4 lower_half(Float8 a) { return _mm256_castps256_ps128(a); }
inline Float4 upper_half(Float8 a) { return _mm256_extractf128_ps(a, 1); }
inline Float8 both_halves(Float4 lower, Float4 upper) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(lower), upper, 1);
}
inline Quads<Float8> transposed(Float8 a, Float8 b, Float8 c, Float8 d) {
  const Float8 ab_lo = _mm256_unpacklo_ps(a, b), ab_hi = _mm256_unpackhi_ps(a, b), cd_lo = _mm256_unpacklo_ps(c, d),
               cd_hi = _mm256_unpackhi_ps(c, d);
  return {_mm256_shuffle_ps(ab_lo, cd_lo, 0x44), _mm256_shuffle_ps(ab_lo, cd_lo, 0xee),
          _mm256_shuffle_ps(ab_hi, cd_hi, 0x44), _mm256_shuffle_ps(ab_hi, cd_hi, 0xee)};
}

#else

struct Float8 {
  Float4 lower, upper;
  friend Float8 operator+(Float8 a, Float8 b) { return {a.lower + b.lower, a.upper + b.upper}; }
  friend Float8 operator-(Float8 a, Float8 b) { return {a.lower - b.lower, a.upper - b.upper}; }
  friend Float8 operator*(Float8 a, Float8 b) { return {a.lower * b.lower, a.upper * b.upper}; }
  friend Float8 operator/(Float8 a, Float8 b) { return {a.lower / b.lower, a.upper / b.upper}; }
};
struct Int8 {
  Int4 lower, upper;
  friend Int8 operator-(Int8 a, Int8 b) { return {a.lower - b.lower, a.upper - b.upper}; }
  friend Int8 operator<(Int8 a, Int8 b) { return {a.lower < b.lower, a.upper < b.upper}; }
  friend Int8 operator==(Int8 a, Int8 b) { return {a.lower == b.lower, a.upper == b.upper}; }
};
inline Int8 operator<(Float8 a, Float8 b) { return {a.lower < b.lower, a.upper < b.upper}; }
inline Int8 operator<=(Float8 a, Float8 b) { return {a.lower <= b.lower, a.upper <= b.upper}; }
inline Int8 operator==(Float8 a, Float8 b) { return {a.lower == b.lower, a.upper == b.upper}; }

inline Float8 all8(float v) { return {v - Float4{}, v - Float4{}}; }
inline Int8 ints8(std::int32_t v) { return {v + Int4{}, v + Int4{}}; }
inline Int8 select(Int8 mask, Int8 yes, Int8 no) {
  return {mask.lower ? yes.lower : no.lower, mask.upper ? yes.upper : no.upper};
}
inline Float8 min(Float8 a, Float8 b) { return {min(a.lower, b.lower), min(a.upper, b.upper)}; }
inline Float8 max(Float8 a, Float8 b) { return {max(a.lower, b.lower), max(a.upper, b.upper)}; }
inline Float8 sqrt(Float8 a) { return {sqrt(a.lower), sqrt(a.upper)}; }
inline unsigned bits(Int8 mask) { return bits(mask.lower) | bits(mask.upper) << 4; }
// Lanes of `yes` where the bit is set, of `no` elsewhere.
inline Float8 select(unsigned bits, Float8 yes, Float8 no) {
  const Int4 lower{1, 2, 4, 8}, upper{16, 32, 64, 128}, all = static_cast<std::int32_t>(bits) + Int4{};
  return {(all & lower) == lower ? yes.lower : no.lower, (all & upper) == upper ? yes.upper : no.upper};
}
inline float pick(Float8 a, unsigned lane) { return lane < 4 ? a.lower[lane] : a.upper[lane - 4]; }
inline Float8 spread(Float8 a, unsigned lane) { return all8(pick(a, lane)); }
// In each lane the value of the next one in a ring of n lanes.
inline Float8 rotate(Float8 a, unsigned n) {
  float from[8], to[8];
  std::memcpy(from, &a, sizeof a);
  for (int k = 0; k < 8; ++k) to[k] = from[next_in_ring[n][k]];
  std::memcpy(&a, to, sizeof a);
  return a;
}
inline Float4 lower_half(Float8 a) { return a.lower; }
inline Float4 upper_half(Float8 a) { return a.upper; }
inline Float8 both_halves(Float4 lower, Float4 upper) { return {lower, upper}; }
inline Quads<Float8> transposed(Float8 a, Float8 b, Float8 c, Float8 d) {
  const auto lower = transposed(a.lower, b.lower, c.lower, d.lower);
  const auto upper = transposed(a.upper, b.upper, c.upper, d.upper);
  return {{lower.a, upper.a}, {lower.b, upper.b}, {lower.c, upper.c}, {lower.d, upper.d}};
}

#endif

inline float lowest(Float8 a) {
  const Float4 half = min(lower_half(a), upper_half(a));
  const Float4 pair = min(half, __builtin_shufflevector(half, half, 2, 3, 2, 3));
  return pair[0] < pair[1] ? pair[0] : pair[1];
}
// Lane i of rows[k] and lane k of rows[i] change places.
inline void transpose(Float8 (&rows)[8]) {
#if defined(__AVX2__)
  const auto low = [](Float8 a, Float8 b) { return _mm256_castps_pd(_mm256_unpacklo_ps(a, b)); };
  const auto high = [](Float8 a, Float8 b) { return _mm256_castps_pd(_mm256_unpackhi_ps(a, b)); };
  Float8 quarters[8];  // lanes k and k + 4 of four rows, first of the upper then of the lower four
  for (int i = 0; i < 8; i += 4) {
    const __m256d low01 = low(rows[i], rows[i + 1]), low23 = low(rows[i + 2], rows[i + 3]);
    const __m256d high01 = high(rows[i], rows[i + 1]), high23 = high(rows[i + 2], rows[i + 3]);
    quarters[i] = _mm256_castpd_ps(_mm256_unpacklo_pd(low01, low23));
    quarters[i + 1] = _mm256_castpd_ps(_mm256_unpackhi_pd(low01, low23));
    quarters[i + 2] = _mm256_castpd_ps(_mm256_unpacklo_pd(high01, high23));
    quarters[i + 3] = _mm256_castpd_ps(_mm256_unpackhi_pd(high01, high23));
  }
  for (int k = 0; k < 4; ++k) {
    rows[k] = _mm256_permute2f128_ps(quarters[k], quarters[k + 4], 0x20);
    rows[k + 4] = _mm256_permute2f128_ps(quarters[k], quarters[k + 4], 0x31);
  }
#else
  float lane[8][8];
  std::memcpy(lane, rows, sizeof lane);
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < i; ++k) std::swap(lane[i][k], lane[k][i]);
  std::memcpy(rows, lane, sizeof lane);
#endif
}

inline Vec3f operator-(const AlignedPoint& a, const AlignedPoint& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

// Columns of the four values that at(lane) points to. Loads of 16 bytes and a transposition are cheaper than gathers on
// every processor tried.
template <class V, class At>
[[gnu::always_inline]] inline Quads<V> load_quads(const At& at) {
  const auto row = [&](int k) {
    const auto four = [&](int lane) { return load<Float4>(reinterpret_cast<const float*>(at(lane))); };
    if constexpr (sizeof(V) == sizeof(Float8)) {
      return both_halves(four(k), four(k + 4));
    } else {
      return four(k);
    }
  };
  return transposed(row(0), row(1), row(2), row(3));
}

// Eight points, one in each lane.
struct Points8 {
  Float8 x, y, z;
};
template <class Ids>
inline Points8 gather(const AlignedPoint* points, const Ids* ids) {
  const Quads<Float8> q = load_quads<Float8>([&](int k) { return &points[ids[k]]; });
  return {q.a, q.b, q.c};
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone
