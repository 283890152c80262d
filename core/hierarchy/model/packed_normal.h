// Unit normals in four bytes.
#pragma once

#include <cstdint>

#include "core/math/vec3.h"

namespace lodestone {

// A unit normal as two 16-bit signed octahedral coordinates (Meyer et al. 2010): 4 bytes, error below 0.004 degrees.
struct PackedNormal {
  std::int16_t u = 0, v = 0;
  friend constexpr bool operator==(const PackedNormal&, const PackedNormal&) = default;
};
[[nodiscard]] PackedNormal pack_normal(Vec3f n);         // n need not be of unit length; zero gives +z
[[nodiscard]] Vec3f unpack_normal(PackedNormal packed);  // of unit length within rounding

}  // namespace lodestone
