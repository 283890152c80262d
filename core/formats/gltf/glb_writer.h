// Binary glTF 2.0 (Khronos Group, 2021): one node, one primitive per material, textures inside.
#pragma once

#include <cstddef>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/formats/common/mesh_view.h"

namespace lodestone {

// Positions are float32 relative to the middle of the mesh, which the node's translation adds, so that a model far from
// the origin loses nothing. Normals, texture coordinates and colours where the view has them; materials without metal.
// Textures in other formats than PNG and JPEG are declared by the extensions that allow them (WebP, KTX2). Throws
// ResourceError for more than 4 GiB, which the format cannot hold.
[[nodiscard]] std::vector<std::byte> encode_glb(const MeshView& mesh);

void write_glb(AtomicFile& file, const MeshView& mesh);

}  // namespace lodestone
