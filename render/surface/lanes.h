// Vectors of floats or integers in a register: four with what every x86-64 has (or any processor that GCC and Clang
// compile vectors for), eight with AVX2. A lane is a vertex, a triangle or a pixel and never looks at its neighbours;
// every operation is one IEEE rounding, so that any width gives the same bytes.
//
// A file that includes this is compiled once for each instruction set; LODESTONE_LANES names the namespace, so that
// the linker cannot mix them up.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/math/lanes/float8.h"

// Effects (render/effects) have their code for lanes if this is defined.
#define LODESTONE_SHADING_LANES

namespace lodestone::soft::LODESTONE_LANES {

#if defined(__AVX2__)
inline constexpr int width = 8;
using Float = Float8;
using Int = Int8;
#else
inline constexpr int width = 4;
using Float = Float4;
using Int = Int4;
#endif

using Unsigned = std::uint32_t __attribute__((vector_size(4 * width)));
using HalfInt = std::int32_t __attribute__((vector_size(2 * width)));
using HalfFloat = float __attribute__((vector_size(2 * width)));
using HalfDouble = double __attribute__((vector_size(4 * width)));

using lodestone::select;  // beside those of points
inline Float all(float v) { return v - Float{}; }
inline Int all(std::int32_t v) { return Int{} + v; }
inline Int iota() {
#if defined(__AVX2__)
  return Int{0, 1, 2, 3, 4, 5, 6, 7};
#else
  return Int{0, 1, 2, 3};
#endif
}
inline Int as_int(Float v) { return reinterpret_cast<Int>(v); }
inline Float as_float(Int v) { return reinterpret_cast<Float>(v); }
// Wraps where it overflows, for lanes whose result is not looked at.
inline Int wrapping_product(Int a, Int b) {
  return reinterpret_cast<Int>(reinterpret_cast<Unsigned>(a) * reinterpret_cast<Unsigned>(b));
}
inline Int wrapping_difference(Int a, Int b) {
  return reinterpret_cast<Int>(reinterpret_cast<Unsigned>(a) - reinterpret_cast<Unsigned>(b));
}
inline Float to_float(Int v) { return __builtin_convertvector(v, Float); }
inline Int truncated(Float v) { return __builtin_convertvector(v, Int); }

inline constexpr unsigned all_lanes = (1u << width) - 1;

// To the nearest, ties to even.
inline Int rounded(Float v) {
#if defined(__AVX2__)
  return reinterpret_cast<Int>(_mm256_cvtps_epi32(v));
#elif defined(__SSE2__)
  return reinterpret_cast<Int>(_mm_cvtps_epi32(v));
#else
  Int r;
  for (int k = 0; k < width; ++k) r[k] = static_cast<std::int32_t>(std::nearbyint(v[k]));
  return r;
#endif
}

// Twice the width in double, for products that must be exact.
struct Double {
  HalfDouble lo, hi;
  friend Double operator+(Double a, Double b) { return {a.lo + b.lo, a.hi + b.hi}; }
  friend Double operator-(Double a, Double b) { return {a.lo - b.lo, a.hi - b.hi}; }
  friend Double operator*(Double a, Double b) { return {a.lo * b.lo, a.hi * b.hi}; }
};
inline Double all(double v) { return {v - HalfDouble{}, v - HalfDouble{}}; }
inline Double to_double(Int v) {
  HalfInt half[2];
  std::memcpy(half, &v, sizeof v);
  return {__builtin_convertvector(half[0], HalfDouble), __builtin_convertvector(half[1], HalfDouble)};
}
inline Float to_float(Double v) {
  const HalfFloat half[2]{__builtin_convertvector(v.lo, HalfFloat), __builtin_convertvector(v.hi, HalfFloat)};
  Float r;
  std::memcpy(&r, half, sizeof r);
  return r;
}

// Appends the lanes whose bits are set; room for a full vector is needed. Returns the new end.
#if defined(__AVX2__)
// For every set of lanes, their numbers first.
struct LaneOrders {
  std::uint8_t of[256][8];
};
inline constexpr LaneOrders lane_orders = [] {
  LaneOrders orders{};
  for (unsigned mask = 0; mask < 256; ++mask) {
    unsigned n = 0;
    for (unsigned k = 0; k < 8; ++k)
      if (mask >> k & 1) orders.of[mask][n++] = static_cast<std::uint8_t>(k);
  }
  return orders;
}();
inline std::uint32_t* append(std::uint32_t* to, Int lanes, unsigned mask) {
  const __m256i order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(lane_orders.of[mask])));
  store(to, reinterpret_cast<Int>(_mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(lanes), order)));
  return to + std::popcount(mask);
}
#else
inline std::uint32_t* append(std::uint32_t* to, Int lanes, unsigned mask) {
  for (int k = 0; k < width; ++k) {
    *to = static_cast<std::uint32_t>(lanes[k]);
    to += mask >> k & 1;
  }
  return to;
}
#endif

struct Points {
  Float x, y, z;
};
struct Vertices {
  Int x, y;
  Float z, inverse_w;
};

// Columns of the two values that upper(lane) points to and the two that lower(lane) does, anywhere.
template <class Upper, class Lower>
[[gnu::always_inline]] inline Quads<Float> load_pairs(const Upper& upper, const Lower& lower) {
#if defined(__SSE2__)
  const auto both = [&](int k) {
    const auto first = _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(upper(k))));
    return _mm_loadh_pi(first, reinterpret_cast<const __m64*>(lower(k)));
  };
#endif
#if defined(__AVX2__)
  const auto row = [&](int k) -> Float { return both_halves(both(k), both(k + 4)); };
#elif defined(__SSE2__)
  const auto row = [&](int k) -> Float { return both(k); };
#else
  const auto row = [&](int k) {
    Float r;
    std::memcpy(&r, upper(k), 8);
    std::memcpy(reinterpret_cast<char*>(&r) + 8, lower(k), 8);
    return r;
  };
#endif
  return transposed(row(0), row(1), row(2), row(3));
}

// The vertices that at(lane) points to.
template <class At>
[[gnu::always_inline]] inline Vertices load_vertices(const At& at) {
  const auto q = load_quads<Float>(at);
  return {as_int(q.a), as_int(q.b), q.c, q.d};
}

// Lane k is from(k). It is made in registers: a vector cannot be loaded before all its parts are stored.
template <class From>
[[gnu::always_inline]] inline Int gathered(const From& from) {
#if defined(__AVX2__)
  return Int{from(0), from(1), from(2), from(3), from(4), from(5), from(6), from(7)};
#else
  return Int{from(0), from(1), from(2), from(3)};
#endif
}

// One after the other.
inline void store_vertices(float* f, const Vertices& v) {
  const auto q = transposed(as_float(v.x), as_float(v.y), v.z, v.inverse_w);
#if defined(__AVX2__)
  _mm256_storeu_ps(f, _mm256_permute2f128_ps(q.a, q.b, 0x20));
  _mm256_storeu_ps(f + 8, _mm256_permute2f128_ps(q.c, q.d, 0x20));
  _mm256_storeu_ps(f + 16, _mm256_permute2f128_ps(q.a, q.b, 0x31));
  _mm256_storeu_ps(f + 24, _mm256_permute2f128_ps(q.c, q.d, 0x31));
#else
  store(f, q.a), store(f + 4, q.b), store(f + 8, q.c), store(f + 12, q.d);
#endif
}

// Consecutive points.
inline Points load_points(const Vec3f* from) {
  const auto* f = reinterpret_cast<const float*>(from);
#if defined(__AVX2__)
  // Four points in each half: x y z x, y z x y, z x y z.
  const auto pair = [&](int k) { return both_halves(load<Float4>(f + k), load<Float4>(f + 12 + k)); };
  const Float a = pair(0), b = pair(4), c = pair(8);
  const Float xy = _mm256_shuffle_ps(b, c, 0x9e);  // x2 y2 x3 y3
  const Float yz = _mm256_shuffle_ps(a, b, 0x49);  // y0 z0 y1 z1
  return {_mm256_shuffle_ps(a, xy, 0x8c), _mm256_shuffle_ps(yz, xy, 0xd8), _mm256_shuffle_ps(yz, c, 0xcd)};
#else
  const Float a = load<Float>(f), b = load<Float>(f + 4), c = load<Float>(f + 8);
  const Float xy = __builtin_shufflevector(b, c, 2, 3, 5, 6), yz = __builtin_shufflevector(a, b, 1, 2, 4, 5);
  return {__builtin_shufflevector(a, xy, 0, 3, 4, 6), __builtin_shufflevector(yz, xy, 0, 2, 5, 7),
          __builtin_shufflevector(yz, c, 1, 3, 4, 7)};
#endif
}

}  // namespace lodestone::soft::LODESTONE_LANES
