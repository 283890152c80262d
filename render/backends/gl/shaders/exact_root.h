// The square root of a float as IEEE 754 rounds it, in GLSL: that of the CPU on every device.
//
// OpenGL allows sqrt to be off by some units in the last place. The exact one is found in integers: the floor of the
// root of a number of 49 or 50 bits has 25, one more than a float, and tells which float is the nearest, as the root of
// a float is never in the middle between two.
#pragma once

namespace lodestone {

// float exact_root(float s), for s >= 0, infinity included.
inline constexpr const char* exact_root_source = R"(
bool square_exceeds(uint q, uint high, uint low) {
  uint h, l;
  umulExtended(q, q, h, l);
  return h > high || (h == high && l > low);
}

float exact_root(float s) {
  uint bits = floatBitsToUint(s);
  if (bits == 0u || bits >= 0x7f800000u) return s;
  int exponent = int(bits >> 23);  // s = digits 2^(exponent - 150)
  uint digits = bits & 0x7fffffu;
  if (exponent > 0) {
    digits |= 0x800000u;
  } else {
    int shift = 23 - findMSB(digits);
    digits <<= shift;
    exponent = 1 - shift;
  }
  int shift = 26 - (exponent & 1);  // an even power of 2 remains
  uint high = digits >> (32 - shift), low = digits << shift;
  uint q = uint(sqrt(float(digits) * float(1u << shift)));  // nearly the root
  while (square_exceeds(q, high, low)) --q;
  while (!square_exceeds(q + 1u, high, low)) ++q;
  uint rounded = (q + 1u) >> 1;
  int power = (exponent - 150 - shift) / 2 + 1;  // the root = rounded 2^power
  return uintBitsToFloat((uint(power + 150) << 23) + (rounded - 0x800000u));
}
)";

}  // namespace lodestone
