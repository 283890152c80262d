// Wavefront material libraries (.mtl).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/texture_set.h"

namespace lodestone {

// A statement such as "map_Kd -clamp on wood.png".
struct MtlTexture {
  std::string file;
  TextureWraps wraps;
  std::string place;  // line of the library
};

struct MtlMaterial {
  std::string name;
  std::array<float, 4> colour{1, 1, 1, 1};  // Kd and d (or 1 - Tr)
  std::optional<MtlTexture> texture;        // map_Kd
  std::optional<MtlTexture> normal_map;     // norm, map_Bump or bump
};

// The statements newmtl, Kd, d, Tr, map_Kd, norm, map_Bump and bump; others are skipped, as are the options of maps
// but -clamp. Colours are clamped to [0, 1]. Throws InputError naming the line for a statement without its values.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(ByteReader& input);

}  // namespace lodestone
