// The sixteen lanes of a ring, once in plain C++, which says what each operation means, and once in a register of AVX2,
// with the masks and shifts of lanes that AVX-512 has for it.
#pragma once

#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "core/base/instruction_set.h"
#include "core/simplify/quadric/block_arrays.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

#if !defined(__AVX2__)

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
  // The first lane that equals the id; 16 if none does.
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
  // The ring without lane `at`: the neighbours after it move up; the flags are kept.
  [[nodiscard]] Id16 without(unsigned at) const {
    Id16 r = *this;
    for (unsigned k = at; k < ring_capacity; ++k) r.lane[k] = lane[k + 1];
    return r;
  }
  // The ring with lane `at` replaced by `length` others; the flags are kept.
  static Id16 spliced(const Ring& ring, unsigned at, const Id* others, unsigned length) {
    Id16 r;
    for (unsigned k = 0; k < ring_capacity; ++k)
      r.lane[k] = k < at ? ring.lane[k] : k < at + length ? others[k - at] : ring.lane[k + 1 - length];
    r.lane[flags_lane - 1] = none;
    r.lane[flags_lane] = ring.lane[flags_lane];
    return r;
  }
  // Follows the link of a closed fan of 3 to 8 triangles. False if it is not one; the ring is undefined then.
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
  // The number of the first n lanes that are among the first m of the other; no lane occurs twice.
  [[nodiscard]] unsigned count_common(unsigned n, const Id16& other, unsigned m) const {
    unsigned common = 0;
    for (unsigned k = 0; k < n; ++k) common += other.find(lane[k]) < m;
    return common;
  }
};

#else

struct Id16 {
  __m256i lanes;

  static Id16 load(const Id* ids) { return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(ids))}; }
  static Id16 all_none() { return {_mm256_set1_epi16(-1)}; }
  void store(Id* ids) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(ids), lanes); }
  [[nodiscard]] __m256i equal(Id id) const {
    return _mm256_cmpeq_epi16(lanes, _mm256_set1_epi16(static_cast<short>(id)));
  }
#if defined(LODESTONE_AVX512)
  [[nodiscard]] __mmask16 lanes_with(Id id) const {
    return _mm256_cmpeq_epi16_mask(lanes, _mm256_set1_epi16(static_cast<short>(id)));
  }
  [[nodiscard]] unsigned find(Id id) const { return _tzcnt_u32(lanes_with(id) | 0x1'0000u); }
  [[nodiscard]] bool same(Id16 other) const { return _mm256_cmpneq_epi16_mask(lanes, other.lanes) == 0; }
  [[nodiscard]] Id16 replace(Id from, Id to) const {
    return {_mm256_mask_mov_epi16(lanes, lanes_with(from), _mm256_set1_epi16(static_cast<short>(to)))};
  }
  // The last two lanes, a `none` and the flags, are kept.
  [[nodiscard]] Id16 without(unsigned at) const {
    return {_mm256_mask_compress_epi16(lanes, static_cast<__mmask16>(0x7fff & ~(1u << at)), lanes)};
  }
  static Id16 spliced(const Ring& ring, unsigned at, const Id* others, unsigned length) {
    const __m256i before = load(ring.lane).lanes, between = load(others - at).lanes;
    const __m256i after = load(ring.lane + 1 - static_cast<int>(length)).lanes;
    const unsigned from = 0x7fffu << at & 0x7fff;
    const __m256i lanes = _mm256_mask_mov_epi16(_mm256_mask_mov_epi16(before, static_cast<__mmask16>(from), between),
                                                static_cast<__mmask16>(from << length & 0x7fff), after);
    return {_mm256_mask_mov_epi16(lanes, 0x4000, _mm256_set1_epi16(-1))};
  }
  static __m256i lanes_from(unsigned first) { return _mm256_movm_epi16(static_cast<__mmask16>(0xffffu << first)); }
#else
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
    // The last two lanes, a `none` and the flags, are kept.
    return {_mm256_blend_epi32(_mm256_blendv_epi8(lanes, moved_up, lanes_from(at)), lanes, 0x80)};
  }
  static Id16 spliced(const Ring& ring, unsigned at, const Id* others, unsigned length) {
    const __m256i before = load(ring.lane).lanes, between = load(others - at).lanes;
    const __m256i after = load(ring.lane + 1 - static_cast<int>(length)).lanes;
    const __m256i lanes =
        _mm256_blendv_epi8(_mm256_blendv_epi8(before, between, lanes_from(at)), after, lanes_from(at + length));
    // The last two lanes are a `none` and the flags.
    return {_mm256_blend_epi32(lanes, _mm256_or_si256(before, _mm256_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0xffff)), 0x80)};
  }
#endif
  static bool closed_fan(const Link& link, unsigned n, Id* ring) {
    const __m128i beyond = _mm256_castsi256_si128(lanes_from(n));
    const __m256i edges = _mm256_load_si256(reinterpret_cast<const __m256i*>(link.edge));
    const __m256i halves = _mm256_permute4x64_epi64(
        _mm256_packus_epi32(_mm256_blend_epi16(edges, _mm256_setzero_si256(), 0xaa), _mm256_srli_epi32(edges, 16)),
        0xd8);
    const __m128i from = _mm_or_si128(_mm256_castsi256_si128(halves), beyond);
    const __m128i next = successors(from, _mm256_extracti128_si256(halves, 1));
    // Exactly one edge starts at each of the first n ends.
    const __m128i once = _mm_cmpeq_epi8(_mm_and_si128(next, _mm_set1_epi8(~7)), _mm_set1_epi8(8));
    // The edge that the path from edge 0 has reached after 0 to 15 steps; each line doubles the steps known.
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
    Id16{_mm256_inserti128_si256(_mm256_set1_epi16(-1), _mm_or_si128(ids, beyond), 0)}.store(ring);
    const unsigned first = (1u << n) - 1;
    return (known & first) == first && (returns & (2 * first + 1)) == (first + 2);
  }
  // Byte k: 8 + the index of the one edge that starts where edge k ends; another value if there is none or several.
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

#endif

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
