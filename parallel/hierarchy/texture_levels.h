// Copies of textures for coarser levels, made by all workers.
#pragma once

#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Fills hierarchy.texture_copies with what core/hierarchy/model/level_mesh.h makes of each texture. One that cannot be
// decoded is left as it is at all levels: a warning each, in the order of the textures. The same bytes for any number
// of workers. Memory: for each worker's texture, 20 bytes per pixel. Throws Cancelled, at the next texture.
[[nodiscard]] std::vector<std::string> add_texture_copies(Hierarchy& hierarchy, Scheduler& scheduler,
                                                          const CancelFlag* cancel = nullptr);

}  // namespace lodestone
