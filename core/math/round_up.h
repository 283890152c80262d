// Rounding outward, for figures that are stored as bounds: what rounds to nearest may end half a step below the truth.
//
// Operations on doubles give the least double that is not below the exact result, as if the processor rounded up: they
// test the sign of the rounding error, which is a double itself and can be computed (shewchuk1997, by fused
// multiply-add for products). Near the smallest normal number it no longer is, and the result is the next double
// instead. Overflow gives infinity.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/vec3.h"

namespace lodestone {

namespace detail {
inline constexpr double error_vanishes = 0x1p-960;  // below it the error of a product may have no double
[[nodiscard]] inline double next_double(double v) { return std::nextafter(v, std::numeric_limits<double>::infinity()); }
}  // namespace detail

// The least float that is not below v, and the largest that is not above.
[[nodiscard]] inline float float_up(double v) {
  const auto f = static_cast<float>(v);
  return f < v ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}
[[nodiscard]] inline float float_down(double v) { return -float_up(-v); }

// Above v >= 0 by at least 2^-25 of it, but 0 for 0: a bound of what a few operations in double have computed, whose
// rounding is millions of times less.
[[nodiscard]] inline float float_above(double v) {
  return v > 0 ? std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity()) : 0.0f;
}

[[nodiscard]] inline double sum_up(double a, double b) {
  const double sum = a + b, of_b = sum - a;
  const double error = (a - (sum - of_b)) + (b - of_b);
  return error > 0 ? detail::next_double(sum) : sum;
}

// The product of a, b >= 0.
[[nodiscard]] inline double product_up(double a, double b) {
  const double product = a * b;
  const bool below = product < detail::error_vanishes ? a > 0 && b > 0 : std::fma(a, b, -product) > 0;
  return below ? detail::next_double(product) : product;
}

// The quotient of a >= 0 and b > 0.
[[nodiscard]] inline double quotient_up(double a, double b) {
  const double quotient = a / b;
  const bool below =
      a < detail::error_vanishes || quotient < detail::error_vanishes ? a > 0 : std::fma(-quotient, b, a) > 0;
  return below ? detail::next_double(quotient) : quotient;
}

// The square root of a >= 0.
[[nodiscard]] inline double root_up(double a) {
  const double root = std::sqrt(a);
  const bool below = a < detail::error_vanishes ? a > 0 : std::fma(-root, root, a) > 0;
  return below ? detail::next_double(root) : root;
}

// A bound of the length of v.
[[nodiscard]] inline double length_up(Vec3d v) {
  return root_up(sum_up(sum_up(product_up(std::abs(v.x), std::abs(v.x)), product_up(std::abs(v.y), std::abs(v.y))),
                        product_up(std::abs(v.z), std::abs(v.z))));
}

}  // namespace lodestone
