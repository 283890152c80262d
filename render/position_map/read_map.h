// The last step of reading a position map, common to all formats.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "render/position_map/position_map.h"

namespace lodestone {

// Completes and checks a map of `view`, whose width and height are set, with positions and the other channels of the
// file; empty arrays are filled in or left empty as map_files.h describes. `name` names the file in messages.
void complete_map(PositionMap& map, const std::string& name);

// The readers of map_files.h on bytes in memory; `name` names the file in messages. They throw InputError.
[[nodiscard]] PositionMap parse_exr_map(std::span<const std::byte> bytes, const std::string& name, const MapView& view,
                                        const Transform& transform);
[[nodiscard]] PositionMap parse_pfm_map(std::span<const std::byte> bytes, const std::string& name, const MapView& view,
                                        const Transform& transform);

}  // namespace lodestone
