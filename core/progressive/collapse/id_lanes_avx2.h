// Eight ids in an AVX2 register. Only for translation units compiled for that, as core/simplify/quadric/lanes_avx2.h.
#pragma once

#include <immintrin.h>

#include "core/progressive/collapse/ring.h"
#include "core/simplify/quadric/lanes_avx2.h"

namespace lodestone::progressive::avx2 {

struct Id8 {
  __m256i lanes;

  static Id8 load(const Id* ids) { return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(ids))}; }
  void store(Id* ids) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(ids), lanes); }
  static __m256i all(Id id) { return _mm256_set1_epi32(static_cast<int>(id)); }
  [[nodiscard]] Id8 first(int n, Id other) const {
    const __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    return {_mm256_blendv_epi8(all(other), lanes, _mm256_cmpgt_epi32(_mm256_set1_epi32(n), index))};
  }
  [[nodiscard]] Matches among(const Id* others, std::uint32_t count) const {
    __m256i times = _mm256_setzero_si256();
    for (std::uint32_t i = 0; i < count; ++i)
      times = _mm256_sub_epi32(times, _mm256_cmpeq_epi32(lanes, all(others[i])));
    const auto above = [&](int n) {
      const __m256i more = _mm256_cmpgt_epi32(times, _mm256_set1_epi32(n));
      return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(more)));
    };
    return {above(0), above(1)};
  }
  // Bit k: lane k is the id.
  [[nodiscard]] unsigned equal(Id id) const {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(lanes, all(id)))));
  }
};

struct Lanes {
  using Float = quadric::avx2::Float8;
  using Points = quadric::avx2::Point8;
  using Ids = Id8;
};

}  // namespace lodestone::progressive::avx2
