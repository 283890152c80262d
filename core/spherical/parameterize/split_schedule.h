// The order in which vertices come in: levels, after each of which all are moved, and waves within them, whose splits
// share no vertex and may happen side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::spherical {

using progressive::Id;

// A collapse, to be undone.
struct VertexSplit {
  Id vertex = 0, target = 0;
  std::uint32_t ring = 0;  // the number of neighbours that the vertex had
};

struct SplitSchedule {
  std::vector<VertexSplit> splits;  // in the order in which they happen
  std::vector<std::size_t> waves;   // where each begins in splits; and the end
  std::vector<std::size_t> levels;  // where each begins in waves; and the end
};

// From collapses in the order in which they happened, with the rings as they left them. The levels grow by `growth`, at
// least by a vertex; those below a hundred vertices by its square root. The last of them is complete.
[[nodiscard]] SplitSchedule make_split_schedule(const progressive::RingMesh& rings,
                                                std::span<const VertexSplit> collapses, double growth);

}  // namespace lodestone::spherical
