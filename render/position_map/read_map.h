// What reading a position map ends with, whatever the format.
#pragma once

#include <string>

#include "render/position_map/position_map.h"

namespace lodestone {

// A map of `view`, in which width and height are set, with positions, and whatever else the file had; empty arrays are
// filled in or left empty as map_files.h says. Checks it, too; `name` stands for the file in messages.
void complete_map(PositionMap& map, const std::string& name);

}  // namespace lodestone
