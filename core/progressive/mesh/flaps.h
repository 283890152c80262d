// Flaps: parts that were cut off at edges of more than two triangles and are too small to collapse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::progressive {

// Every vertex of a flap is in the base, and one of them at least lies where a vertex of a part lies that does
// collapse: no point of the flap is farther than its extent from that part, and not much more than half of it if that
// is true of all of them. Raises the activations (activation.h) of its triangles: they are in all levels whose error is
// below that distance, and in the finest one. `triangles`: of the finest level, in any order; activations likewise.
void delay_flaps(const ProgressiveMesh& mesh, const std::vector<std::uint32_t>& groups,
                 std::span<const Triangle> triangles, std::span<std::uint32_t> activations);

}  // namespace lodestone::progressive
