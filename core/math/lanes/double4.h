// Four doubles at a time, as core/math/lanes/float8.h has eight floats: one register with AVX2, two without, and the
// same bits from both. Bit k of a mask stands for lane k.
#pragma once

#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "core/base/instruction_set.h"
#include "core/math/lanes/float4.h"
#include "core/math/vec3.h"

namespace lodestone {

// A point in four doubles, so that one load takes it.
struct alignas(32) AlignedPoint4d {
  double x = 0, y = 0, z = 0, unused = 0;

  AlignedPoint4d() = default;
  AlignedPoint4d(Vec3d p) : x(p.x), y(p.y), z(p.z) {}
  [[nodiscard]] Vec3d point() const { return {x, y, z}; }
};

inline namespace LODESTONE_LANES {

#if defined(__AVX2__)

using Double4 = double __attribute__((vector_size(32)));
using Mask4 = std::int64_t __attribute__((vector_size(32)));

inline Double4 all4d(double v) { return _mm256_set1_pd(v); }
inline Double4 select(Mask4 mask, Double4 yes, Double4 no) {
  return _mm256_blendv_pd(no, yes, reinterpret_cast<__m256d>(mask));
}
inline Double4 min(Double4 a, Double4 b) { return _mm256_min_pd(a, b); }
inline Double4 max(Double4 a, Double4 b) { return _mm256_max_pd(a, b); }
inline Double4 sqrt(Double4 a) { return _mm256_sqrt_pd(a); }
inline Double4 abs(Double4 a) { return _mm256_andnot_pd(all4d(-0.0), a); }
inline Double4 copysign(Double4 v, Double4 sign) {
  return _mm256_or_pd(_mm256_andnot_pd(all4d(-0.0), v), _mm256_and_pd(all4d(-0.0), sign));
}
inline unsigned bits(Mask4 mask) { return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask))); }
inline Float4 narrow(Double4 a) { return __builtin_convertvector(a, Float4); }
inline Int4 narrow(Mask4 a) { return __builtin_convertvector(a, Int4); }

#else

using Double2 = double __attribute__((vector_size(16)));
using Mask2 = std::int64_t __attribute__((vector_size(16)));

struct Double4 {
  Double2 lower, upper;
  friend Double4 operator+(Double4 a, Double4 b) { return {a.lower + b.lower, a.upper + b.upper}; }
  friend Double4 operator-(Double4 a, Double4 b) { return {a.lower - b.lower, a.upper - b.upper}; }
  friend Double4 operator*(Double4 a, Double4 b) { return {a.lower * b.lower, a.upper * b.upper}; }
  friend Double4 operator/(Double4 a, Double4 b) { return {a.lower / b.lower, a.upper / b.upper}; }
};
struct Mask4 {
  Mask2 lower, upper;
  friend Mask4 operator&(Mask4 a, Mask4 b) { return {a.lower & b.lower, a.upper & b.upper}; }
  friend Mask4 operator|(Mask4 a, Mask4 b) { return {a.lower | b.lower, a.upper | b.upper}; }
};
inline Mask4 operator<(Double4 a, Double4 b) { return {a.lower < b.lower, a.upper < b.upper}; }

inline Double4 all4d(double v) { return {Double2{v, v}, Double2{v, v}}; }
inline Double4 select(Mask4 mask, Double4 yes, Double4 no) {
  return {mask.lower ? yes.lower : no.lower, mask.upper ? yes.upper : no.upper};
}
inline Double4 min(Double4 a, Double4 b) { return select(a < b, a, b); }
inline Double4 max(Double4 a, Double4 b) { return select(b < a, a, b); }
inline Double4 copysign(Double4 v, Double4 sign) {
  const auto half = [](Double2 value, Double2 of) {
    const Mask2 sign_bit{INT64_MIN, INT64_MIN};
    return reinterpret_cast<Double2>((reinterpret_cast<Mask2>(value) & ~sign_bit) |
                                     (reinterpret_cast<Mask2>(of) & sign_bit));
  };
  return {half(v.lower, sign.lower), half(v.upper, sign.upper)};
}
inline Double4 abs(Double4 a) { return copysign(a, all4d(0)); }
inline Float4 narrow(Double4 a) {
  return Float4{static_cast<float>(a.lower[0]), static_cast<float>(a.lower[1]), static_cast<float>(a.upper[0]),
                static_cast<float>(a.upper[1])};
}
inline Int4 narrow(Mask4 a) {
  return Int4{static_cast<std::int32_t>(a.lower[0]), static_cast<std::int32_t>(a.lower[1]),
              static_cast<std::int32_t>(a.upper[0]), static_cast<std::int32_t>(a.upper[1])};
}
#if defined(__SSE2__)
inline Double4 sqrt(Double4 a) { return {_mm_sqrt_pd(a.lower), _mm_sqrt_pd(a.upper)}; }
inline unsigned bits(Mask4 mask) {
  const auto half = [](Mask2 m) { return static_cast<unsigned>(_mm_movemask_pd(reinterpret_cast<__m128d>(m))); };
  return half(mask.lower) | half(mask.upper) << 2;
}
#else
inline Double4 sqrt(Double4 a) {
  for (int k = 0; k < 2; ++k) a.lower[k] = __builtin_sqrt(a.lower[k]), a.upper[k] = __builtin_sqrt(a.upper[k]);
  return a;
}
inline unsigned bits(Mask4 mask) {
  unsigned r = 0;
  for (int k = 0; k < 2; ++k)
    r |= static_cast<unsigned>(mask.lower[k] < 0) << k | static_cast<unsigned>(mask.upper[k] < 0) << (k + 2);
  return r;
}
#endif

#endif

inline Double4 load4(const double* from) {
  Double4 v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline void store(double* to, Double4 v) { std::memcpy(to, &v, sizeof v); }

// Four vectors, one in each lane.
struct Vec4x3 {
  Double4 x, y, z;
};
inline Vec4x3 operator+(const Vec4x3& a, const Vec4x3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec4x3 operator-(const Vec4x3& a, const Vec4x3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec4x3 operator*(Double4 s, const Vec4x3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Double4 dot(const Vec4x3& a, const Vec4x3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec4x3 cross(const Vec4x3& a, const Vec4x3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Id>
inline Vec4x3 gather(const AlignedPoint4d* points, const Id* ids) {
#if defined(__AVX2__)
  // Halves of two points in one register each: loads do most of the shuffling.
  const auto halves = [&](int k, int l, bool upper) {
    const double *low = &points[ids[k]].x + (upper ? 2 : 0), *high = &points[ids[l]].x + (upper ? 2 : 0);
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(low)), _mm_load_pd(high), 1);
  };
  const __m256d xy02 = halves(0, 2, false), xy13 = halves(1, 3, false);
  return {_mm256_unpacklo_pd(xy02, xy13), _mm256_unpackhi_pd(xy02, xy13),
          _mm256_unpacklo_pd(halves(0, 2, true), halves(1, 3, true))};
#else
  double x[4], y[4], z[4];
  for (int k = 0; k < 4; ++k) x[k] = points[ids[k]].x, y[k] = points[ids[k]].y, z[k] = points[ids[k]].z;
  return {load4(x), load4(y), load4(z)};
#endif
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone
