// OpenMesh's decimater as a peer, in a translation unit of its own: its headers take a minute.
#pragma once

#include <vector>

#include "bench/simplify_chunks.h"

namespace lodestone::bench {

// Indices of the triangles left, into the positions of the chunk. Locked vertices stay; the displacement is free.
[[nodiscard]] std::vector<unsigned> decimate_with_openmesh(const Chunk& chunk, double share);

}  // namespace lodestone::bench
