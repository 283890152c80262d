// A progressive mesh as integers: what its codec writes and reads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/attributes.h"

namespace lodestone::progressive {

// What vertices have, as integers. By group, and by wedge; empty when there is none.
struct LatticeValues {
  std::vector<std::array<std::int32_t, 3>> positions;
  std::vector<std::uint16_t> errors;  // the upper half of a float, rounded up
  std::vector<std::array<std::int32_t, 2>> uv;
  std::vector<Rgba8> colours;
  std::vector<std::uint32_t> materials;  // index, or no_material
};

struct CodecSettings {
  std::uint32_t position_bits = 12, uv_bits = 12;
  bool wedges = false, uv = false, colours = false, materials = false;
};

}  // namespace lodestone::progressive
