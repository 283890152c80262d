// Building a hierarchy larger than memory: from a mesh file to a .lode file, byte for byte what build_hierarchy and
// save_lode make of it.
//
// The file is read in pieces and its triangles spilled to disk by cells (parallel/out_of_core/spill.h); blocks take
// their cells from there and write what they make there (parallel/out_of_core/stored_blocks.h). Memory holds 16 bytes
// per vertex of the finest level, what is known of shared vertices, and a block per worker: docs/decisions/0010.
#pragma once

#include "parallel/mesh/mesh_stream.h"
#include "parallel/out_of_core/build_model.h"

namespace lodestone {

// build_model (parallel/out_of_core/build_model.h) for a stream.
[[nodiscard]] ModelResult build_out_of_core(const MeshStream& stream, const ModelConfig& config, Scheduler& scheduler);

}  // namespace lodestone
