// What reading a position map ends with, whatever the format.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "render/position_map/position_map.h"

namespace lodestone {

// A map of `view`, in which width and height are set, with positions, and whatever else the file had; empty arrays are
// filled in or left empty as map_files.h says. Checks it, too; `name` stands for the file in messages.
void complete_map(PositionMap& map, const std::string& name);

// The readers of map_files.h on bytes in memory; `name` stands for the file in messages. They throw InputError.
[[nodiscard]] PositionMap parse_exr_map(std::span<const std::byte> bytes, const std::string& name, const MapView& view,
                                        const Transform& transform);
[[nodiscard]] PositionMap parse_pfm_map(std::span<const std::byte> bytes, const std::string& name, const MapView& view,
                                        const Transform& transform);

}  // namespace lodestone
