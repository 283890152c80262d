// Four floats in a register, by the vector types of GCC and Clang: the same operations as on floats, lane by lane, so
// the same bits, on any processor that they compile for.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "core/base/instruction_set.h"
#include "core/math/vec3.h"

namespace lodestone {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));  // of comparisons: all bits of a lane, or none

struct Float4x3 {
  Float4 x, y, z;
};

// Columns of rows of four values; each four lanes are a row of their own.
template <class V>
struct Quads {
  V a, b, c, d;
};

inline namespace LODESTONE_LANES {

template <class V, class T>
inline V load(const T* from) {
  static_assert(sizeof(T) == 4);
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class V, class T>
inline void store(T* to, V v) {
  static_assert(sizeof(T) == 4);
  std::memcpy(to, &v, sizeof v);
}

// By two loads; the compilers make three of Float4{p.x, p.y, p.z, 0} and put them together again.
inline Float4 to_float4(const Vec3f& p) {
  static_assert(std::endian::native == std::endian::little && sizeof(Vec3f) == 12);
  using Long2 = std::int64_t __attribute__((vector_size(16)));
  std::int64_t xy;
  std::memcpy(&xy, &p.x, sizeof xy);
  return reinterpret_cast<Float4>(Long2{xy, std::bit_cast<std::uint32_t>(p.z)});
}
inline Vec3f to_vec3f(Float4 p) { return {p[0], p[1], p[2]}; }
inline Float4 all4(float v) { return Float4{v, v, v, v}; }
inline bool equal(Int4 a, Int4 b) {
  using Long2 = std::int64_t __attribute__((vector_size(16)));
  const auto difference = reinterpret_cast<Long2>(a ^ b);
  return (difference[0] | difference[1]) == 0;
}
// The second operand if either is not a number. Compilers make several instructions of the conditional with a constant.
inline Float4 min(Float4 a, Float4 b) {
#if defined(__SSE2__)
  return _mm_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}
inline Float4 max(Float4 a, Float4 b) {
#if defined(__SSE2__)
  return _mm_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}
inline Int4 min(Int4 a, Int4 b) { return a < b ? a : b; }
inline Int4 max(Int4 a, Int4 b) { return a > b ? a : b; }
inline Int4 select(Int4 mask, Int4 yes, Int4 no) { return mask ? yes : no; }
inline Float4 select(Int4 mask, Float4 yes, Float4 no) { return mask ? yes : no; }
inline Float4 abs(Float4 a) { return reinterpret_cast<Float4>(reinterpret_cast<Int4>(a) & 0x7fff'ffff); }
inline Float4 copysign(Float4 v, Float4 sign) {
  const Int4 sign_bit{INT32_MIN, INT32_MIN, INT32_MIN, INT32_MIN};
  return reinterpret_cast<Float4>((reinterpret_cast<Int4>(v) & ~sign_bit) | (reinterpret_cast<Int4>(sign) & sign_bit));
}

inline Quads<Float4> transposed(Float4 a, Float4 b, Float4 c, Float4 d) {
  const Float4 ab_lo = __builtin_shufflevector(a, b, 0, 4, 1, 5), ab_hi = __builtin_shufflevector(a, b, 2, 6, 3, 7),
               cd_lo = __builtin_shufflevector(c, d, 0, 4, 1, 5), cd_hi = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {__builtin_shufflevector(ab_lo, cd_lo, 0, 1, 4, 5), __builtin_shufflevector(ab_lo, cd_lo, 2, 3, 6, 7),
          __builtin_shufflevector(ab_hi, cd_hi, 0, 1, 4, 5), __builtin_shufflevector(ab_hi, cd_hi, 2, 3, 6, 7)};
}

// The cross product as z, x, y: the components in the order in which they come out; yzx gives them their own.
inline Float4 yzx(Float4 a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }
inline Float4 cross_zxy(Float4 a, Float4 b) { return a * yzx(b) - yzx(a) * b; }

// Squared lengths of three vectors, added up as `dot` does. The last lane repeats the third.
inline Float4 squared_lengths(Float4 a, Float4 b, Float4 c) {
  a *= a, b *= b, c *= c;
  const Float4 xy = __builtin_shufflevector(a, b, 0, 4, 1, 5), z = __builtin_shufflevector(a, b, 2, 6, 2, 6);
  return (__builtin_shufflevector(xy, c, 0, 1, 4, 4) + __builtin_shufflevector(xy, c, 2, 3, 5, 5)) +
         __builtin_shufflevector(z, c, 0, 1, 6, 6);
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone
