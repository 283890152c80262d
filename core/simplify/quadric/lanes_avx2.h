// Eight floats and one ring in AVX2 registers. The meaning of each operation is in lanes_plain.h.
//
// Only for translation units compiled for AVX2; nothing here may be reached without asking the processor first.
#pragma once

#include <immintrin.h>

#include "core/simplify/quadric/quadric_block.h"

namespace lodestone::quadric::avx2 {

struct Float8 {
  __m256 lanes;

  static Float8 all(float s) { return {_mm256_set1_ps(s)}; }
  static Float8 load(const float* from) { return {_mm256_loadu_ps(from)}; }
  void store(float* to) const { _mm256_storeu_ps(to, lanes); }
  friend Float8 operator+(Float8 a, Float8 b) { return {_mm256_add_ps(a.lanes, b.lanes)}; }
  friend Float8 operator-(Float8 a, Float8 b) { return {_mm256_sub_ps(a.lanes, b.lanes)}; }
  friend Float8 operator*(Float8 a, Float8 b) { return {_mm256_mul_ps(a.lanes, b.lanes)}; }
  friend Float8 operator/(Float8 a, Float8 b) { return {_mm256_div_ps(a.lanes, b.lanes)}; }
};

inline Float8 sqrt(Float8 a) { return {_mm256_sqrt_ps(a.lanes)}; }
inline Float8 max(Float8 a, Float8 b) { return {_mm256_max_ps(a.lanes, b.lanes)}; }
inline Float8 min(Float8 a, Float8 b) { return {_mm256_min_ps(a.lanes, b.lanes)}; }

inline unsigned less(Float8 a, Float8 b) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.lanes, b.lanes, _CMP_LT_OQ)));
}
inline unsigned not_above(Float8 a, Float8 b) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.lanes, b.lanes, _CMP_LE_OQ)));
}
inline Float8 select(unsigned bits, Float8 yes, Float8 no) {
  const __m256i lane_bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i set =
      _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), lane_bit), lane_bit);
  return {_mm256_blendv_ps(no.lanes, yes.lanes, _mm256_castsi256_ps(set))};
}
inline Float8 spread(Float8 a, unsigned lane) {
  return {_mm256_permutevar8x32_ps(a.lanes, _mm256_set1_epi32(static_cast<int>(lane)))};
}
inline Float8 rotate(Float8 a, unsigned n) {
  alignas(32) static constexpr int lanes_of_ring[9][8]{
      {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {1, 0, 2, 3, 4, 5, 6, 7},
      {1, 2, 0, 3, 4, 5, 6, 7}, {1, 2, 3, 0, 4, 5, 6, 7}, {1, 2, 3, 4, 0, 5, 6, 7},
      {1, 2, 3, 4, 5, 0, 6, 7}, {1, 2, 3, 4, 5, 6, 0, 7}, {1, 2, 3, 4, 5, 6, 7, 0}};
  return {_mm256_permutevar8x32_ps(a.lanes, _mm256_load_si256(reinterpret_cast<const __m256i*>(lanes_of_ring[n])))};
}
inline float pick(Float8 a, unsigned lane) { return _mm256_cvtss_f32(spread(a, lane).lanes); }

inline float lowest(Float8 a) {
  const __m128 half = _mm_min_ps(_mm256_castps256_ps128(a.lanes), _mm256_extractf128_ps(a.lanes, 1));
  const __m128 pair = _mm_min_ps(half, _mm_movehl_ps(half, half));
  return _mm_cvtss_f32(_mm_min_ss(pair, _mm_movehdup_ps(pair)));
}
inline unsigned equal(Float8 a, float value) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.lanes, _mm256_set1_ps(value), _CMP_EQ_OQ)));
}
inline void transpose(Float8 (&rows)[8]) {
  const auto low = [](__m256 a, __m256 b) { return _mm256_castps_pd(_mm256_unpacklo_ps(a, b)); };
  const auto high = [](__m256 a, __m256 b) { return _mm256_castps_pd(_mm256_unpackhi_ps(a, b)); };
  __m256 quarters[8];  // lanes k and k + 4 of four rows, first of the upper then of the lower four
  for (int i = 0; i < 2; ++i) {
    const Float8* r = rows + 4 * i;
    const __m256d low01 = low(r[0].lanes, r[1].lanes), low23 = low(r[2].lanes, r[3].lanes);
    const __m256d high01 = high(r[0].lanes, r[1].lanes), high23 = high(r[2].lanes, r[3].lanes);
    quarters[4 * i] = _mm256_castpd_ps(_mm256_unpacklo_pd(low01, low23));
    quarters[4 * i + 1] = _mm256_castpd_ps(_mm256_unpackhi_pd(low01, low23));
    quarters[4 * i + 2] = _mm256_castpd_ps(_mm256_unpacklo_pd(high01, high23));
    quarters[4 * i + 3] = _mm256_castpd_ps(_mm256_unpackhi_pd(high01, high23));
  }
  for (int k = 0; k < 4; ++k) {
    rows[k].lanes = _mm256_permute2f128_ps(quarters[k], quarters[k + 4], 0x20);
    rows[k + 4].lanes = _mm256_permute2f128_ps(quarters[k], quarters[k + 4], 0x31);
  }
}

struct Point8 {
  Float8 x, y, z;
  // Eight 16-byte loads and a transposition: cheaper than four gathers on every processor tried.
  template <class Ids>
  static Point8 gather(const Point* points, const Ids* ids) {
    const auto at = [&](int k) { return _mm_load_ps(&points[ids[k]].x); };
    const auto pair = [&](int k) { return _mm256_insertf128_ps(_mm256_castps128_ps256(at(k)), at(k + 4), 1); };
    const auto low = [](__m256 a, __m256 b) { return _mm256_castps_pd(_mm256_unpacklo_ps(a, b)); };
    const auto high = [](__m256 a, __m256 b) { return _mm256_castps_pd(_mm256_unpackhi_ps(a, b)); };
    const __m256 p0 = pair(0), p1 = pair(1), p2 = pair(2), p3 = pair(3);
    const __m256d xy01 = low(p0, p1), xy23 = low(p2, p3), z01 = high(p0, p1), z23 = high(p2, p3);
    return {{_mm256_castpd_ps(_mm256_unpacklo_pd(xy01, xy23))},
            {_mm256_castpd_ps(_mm256_unpackhi_pd(xy01, xy23))},
            {_mm256_castpd_ps(_mm256_unpacklo_pd(z01, z23))}};
  }
};

struct Id16 {
  __m256i lanes;

  static Id16 load(const Id* ids) { return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(ids))}; }
  static Id16 all_none() { return {_mm256_set1_epi16(-1)}; }
  void store(Id* ids) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(ids), lanes); }
  static __m256i all(unsigned value) { return _mm256_set1_epi16(static_cast<short>(value)); }
  [[nodiscard]] __m256i equal(Id id) const {
    return _mm256_cmpeq_epi16(lanes, _mm256_set1_epi16(static_cast<short>(id)));
  }
  [[nodiscard]] unsigned find(Id id) const {
    return _tzcnt_u32(static_cast<unsigned>(_mm256_movemask_epi8(equal(id)))) / 2;
  }
  [[nodiscard]] bool same(Id16 other) const {
    const __m256i differ = _mm256_xor_si256(lanes, other.lanes);
    return _mm256_testz_si256(differ, differ) != 0;
  }
  [[nodiscard]] Id16 replace(Id from, Id to) const {
    return {_mm256_blendv_epi8(lanes, _mm256_set1_epi16(static_cast<short>(to)), equal(from))};
  }
  // All bits set from lane `first` on.
  static __m256i lanes_from(unsigned first) {
    alignas(64) static constexpr std::int16_t steps[32]{0,  0,  0,  0,  0,  0,  0,  0,  0,  0,  0,  0,  0,  0,  0,  0,
                                                        -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(steps + 16 - first));
  }
  [[nodiscard]] Id16 without(unsigned at) const {
    // In registers: a load one lane on would reach into the next ring and wait for a store there.
    const __m256i moved_up = _mm256_alignr_epi8(_mm256_permute2x128_si256(lanes, lanes, 0x81), lanes, 2);
    // The last two lanes, a `none` and the flags, stay.
    return {_mm256_blend_epi32(_mm256_blendv_epi8(lanes, moved_up, lanes_from(at)), lanes, 0x80)};
  }
  static Id16 spliced(const Ring& ring, unsigned at, const Id* others, unsigned length) {
    const __m256i before = load(ring.lane).lanes, between = load(others - at).lanes;
    const __m256i behind = load(ring.lane + 1 - static_cast<int>(length)).lanes;
    const __m256i lanes =
        _mm256_blendv_epi8(_mm256_blendv_epi8(before, between, lanes_from(at)), behind, lanes_from(at + length));
    // The last two lanes are a `none` and the flags.
    return {_mm256_blend_epi32(lanes, _mm256_or_si256(before, _mm256_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0xffff)), 0x80)};
  }
  static bool closed_fan(const Link& link, unsigned n, Id* ring) {
    const __m128i behind = _mm256_castsi256_si128(lanes_from(n));
    const __m256i edges = _mm256_load_si256(reinterpret_cast<const __m256i*>(link.edge));
    const __m256i halves = _mm256_permute4x64_epi64(
        _mm256_packus_epi32(_mm256_blend_epi16(edges, _mm256_setzero_si256(), 0xaa), _mm256_srli_epi32(edges, 16)),
        0xd8);
    const __m128i from = _mm_or_si128(_mm256_castsi256_si128(halves), behind);
    const __m128i next = successors(from, _mm256_extracti128_si256(halves, 1));
    // Of each of the first n ends exactly one edge starts.
    const __m128i once = _mm_cmpeq_epi8(_mm_and_si128(next, _mm_set1_epi8(~7)), _mm_set1_epi8(8));
    // Where the path from edge 0 is after 0 to 15 steps; steps and places known double each time.
    __m128i path = _mm_setzero_si128(), by1 = _mm_and_si128(next, _mm_set1_epi8(7));
    const __m128i by2 = _mm_shuffle_epi8(by1, by1), by4 = _mm_shuffle_epi8(by2, by2), by8 = _mm_shuffle_epi8(by4, by4);
    path = _mm_unpacklo_epi8(path, _mm_shuffle_epi8(by1, path));
    path = _mm_unpacklo_epi16(path, _mm_shuffle_epi8(by2, path));
    path = _mm_unpacklo_epi32(path, _mm_shuffle_epi8(by4, path));
    path = _mm_unpacklo_epi64(path, _mm_shuffle_epi8(by8, path));
    const unsigned returns = static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(path, _mm_setzero_si128())));
    const unsigned known = static_cast<unsigned>(_mm_movemask_epi8(once));
    const __m128i pairs = _mm_unpacklo_epi8(path, path);
    const __m128i ids = _mm_shuffle_epi8(from, _mm_add_epi8(_mm_add_epi8(pairs, pairs), _mm_set1_epi16(0x0100)));
    Id16{_mm256_inserti128_si256(_mm256_set1_epi16(-1), _mm_or_si128(ids, behind), 0)}.store(ring);
    const unsigned first = (1u << n) - 1;
    return (known & first) == first && (returns & (2 * first + 1)) == (first + 2);
  }
  // Byte k: 8 + the index of the one edge that starts where edge k ends; something else where there is none or several.
  static __m128i successors(__m128i from, __m128i to) {
    const __m256i starts = _mm256_broadcastsi128_si256(from), ends = _mm256_broadcastsi128_si256(to);
    // Two ends each, so that the sums below come in order.
    alignas(32) static constexpr std::uint16_t end[4][16]{
        {0x0100, 0x0100, 0x0100, 0x0100, 0x0100, 0x0100, 0x0100, 0x0100,  //
         0x0504, 0x0504, 0x0504, 0x0504, 0x0504, 0x0504, 0x0504, 0x0504},
        {0x0302, 0x0302, 0x0302, 0x0302, 0x0302, 0x0302, 0x0302, 0x0302,  //
         0x0706, 0x0706, 0x0706, 0x0706, 0x0706, 0x0706, 0x0706, 0x0706},
        {0x0908, 0x0908, 0x0908, 0x0908, 0x0908, 0x0908, 0x0908, 0x0908,  //
         0x0d0c, 0x0d0c, 0x0d0c, 0x0d0c, 0x0d0c, 0x0d0c, 0x0d0c, 0x0d0c},
        {0x0b0a, 0x0b0a, 0x0b0a, 0x0b0a, 0x0b0a, 0x0b0a, 0x0b0a, 0x0b0a,  //
         0x0f0e, 0x0f0e, 0x0f0e, 0x0f0e, 0x0f0e, 0x0f0e, 0x0f0e, 0x0f0e}};
    const auto starts_at = [&](int i) {
      const __m256i words = _mm256_load_si256(reinterpret_cast<const __m256i*>(end[i]));
      return _mm256_cmpeq_epi16(starts, _mm256_shuffle_epi8(ends, words));
    };
    const __m256i index = _mm256_set1_epi64x(0x0f0e0d0c0b0a0908);
    const auto sums = [&](__m256i a, __m256i b) {
      return _mm256_sad_epu8(_mm256_and_si256(_mm256_packs_epi16(a, b), index), _mm256_setzero_si256());
    };
    const __m256i low = sums(starts_at(0), starts_at(1)), high = sums(starts_at(2), starts_at(3));
    const __m256i all = _mm256_or_si256(low, _mm256_slli_epi64(high, 32));  // 0 4 1 5, 2 6 3 7
    const __m256i place = _mm256_setr_epi8(0, 8, -1, -1, 4, 12, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1,  //
                                           -1, -1, 0, 8, -1, -1, 4, 12, -1, -1, -1, -1, -1, -1, -1, -1);
    const __m256i placed = _mm256_shuffle_epi8(all, place);
    return _mm_or_si128(_mm256_castsi256_si128(placed), _mm256_extracti128_si256(placed, 1));
  }
  [[nodiscard]] unsigned count_common(unsigned n, Id16 other, unsigned m) const {
    constexpr int any_equal = _SIDD_UWORD_OPS | _SIDD_CMP_EQUAL_ANY | _SIDD_BIT_MASK;
    if (n <= 8 && m <= 8) {
      const __m128i found = _mm_cmpestrm(_mm256_castsi256_si128(lanes), static_cast<int>(n),
                                         _mm256_castsi256_si128(other.lanes), static_cast<int>(m), any_equal);
      return static_cast<unsigned>(__builtin_popcount(static_cast<unsigned>(_mm_cvtsi128_si32(found))));
    }
    alignas(32) Id ids[16];
    store(ids);
    __m256i any = _mm256_setzero_si256();
    for (unsigned k = 0; k < n; ++k) any = _mm256_or_si256(any, other.equal(ids[k]));
    return static_cast<unsigned>(__builtin_popcount(static_cast<unsigned>(_mm256_movemask_epi8(any)))) / 2;
  }
};

struct Lanes {
  using Float = Float8;
  using Points = Point8;
  using Ids = Id16;
};

}  // namespace lodestone::quadric::avx2
