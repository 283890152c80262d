// Four vectors of floats, one in each lane.
#pragma once

#include "core/math/lanes/float8.h"

namespace lodestone {
inline namespace LODESTONE_LANES {

inline Float4x3 operator+(const Float4x3& a, const Float4x3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Float4x3 operator-(const Float4x3& a, const Float4x3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Float4x3 operator*(Float4 s, const Float4x3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Float4 dot(const Float4x3& a, const Float4x3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Float4x3 cross(const Float4x3& a, const Float4x3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Float4x3 select(Int4 mask, const Float4x3& yes, const Float4x3& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone
