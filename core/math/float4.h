// Four floats in a register, by the vector types of GCC and Clang: the same operations as on floats, lane by lane, so
// the same bits, on any processor that they compile for.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/math/vec3.h"

namespace lodestone {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));  // of comparisons: all bits of a lane, or none

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
inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 abs(Float4 a) { return reinterpret_cast<Float4>(reinterpret_cast<Int4>(a) & 0x7fff'ffff); }
inline Float4 copysign(Float4 v, Float4 sign) {
  const Int4 sign_bit{INT32_MIN, INT32_MIN, INT32_MIN, INT32_MIN};
  return reinterpret_cast<Float4>((reinterpret_cast<Int4>(v) & ~sign_bit) | (reinterpret_cast<Int4>(sign) & sign_bit));
}

struct Float4x3 {
  Float4 x, y, z;
};
// The components of four vectors.
inline Float4x3 transposed(Float4 a, Float4 b, Float4 c, Float4 d) {
  const Float4 xy_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), xy_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Float4 z_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7), z_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {__builtin_shufflevector(xy_ab, xy_cd, 0, 1, 4, 5), __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 6, 7),
          __builtin_shufflevector(z_ab, z_cd, 0, 1, 4, 5)};
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

}  // namespace lodestone
