// Materials and textures as the last section of a .lode file.
//
//   u32 materials | material x n | u32 textures | texture x n
//   material: string name, 4 floats of base colour, u32 texture, u32 normal map
//   texture: string name, string media type, u8 wrap in u and v, u16 zero, u64 bytes, the bytes
//   string: u32 bytes, the bytes
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/hierarchy/hierarchy.h"

namespace lodestone {

// Empty when there is neither.
[[nodiscard]] std::vector<std::byte> encode_assets(const Hierarchy& hierarchy);

// Returns what is wrong with the bytes, nullptr when nothing is. Empty bytes are no materials and no textures.
[[nodiscard]] const char* decode_assets(std::span<const std::byte> bytes, Hierarchy& hierarchy);

}  // namespace lodestone
