// Materials and textures as the last section of a .lode file.
//
//   u32 materials | material x n | u32 textures | texture x n [| u32 copies | copy x n]
//   material: string name, 4 floats of base colour, u32 texture, u32 normal map
//   texture: string name, string media type, u8 wrap in u and v, u16 zero, u64 bytes, the bytes
//   copy of a texture: u32 texture, u32 halvings, u32 width and height, u64 bytes, the bytes; by texture, then 1, 2,
//   ... halvings; only in files with the feature lode_texture_copies string: u32 bytes, the bytes
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Empty when there is neither.
[[nodiscard]] std::vector<std::byte> encode_assets(const Hierarchy& hierarchy);

// Returns what is wrong with the bytes, nullptr when nothing is. Empty bytes are no materials and no textures.
[[nodiscard]] const char* decode_assets(std::span<const std::byte> bytes, bool has_copies, Hierarchy& hierarchy);

}  // namespace lodestone
