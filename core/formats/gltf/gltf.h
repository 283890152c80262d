// glTF 2.0 (Khronos Group, 2021): reader, and writer of whole meshes as binary glTF.
#pragma once

#include <cstddef>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/mesh_view.h"
#include "core/formats/common/read_config.h"

namespace lodestone {

// Text or binary (told apart by the first bytes): the triangles of the default scene, moved by their nodes. Attributes:
// NORMAL, COLOR_0, TEXCOORD_n, materials in full (core/mesh/attributes.h). Buffers may be compressed by
// KHR_draco_mesh_compression and EXT_meshopt_compression, values by KHR_mesh_quantization; EXT_mesh_gpu_instancing is
// expanded. Not read: points and lines, skins and morph targets (the pose at rest is read), animations, cameras and
// lights, all with a warning; other extensions that a file requires.
[[nodiscard]] RawMesh read_gltf(ByteReader& input, const ReadConfig& config = {});

// One node, one primitive per material, textures inside. Positions are float32 relative to the middle of the mesh,
// which the node's translation adds, so that a model far from the origin loses nothing. Normals, texture coordinates
// and colours are written if the view has them. Triangles without a material get a white one without metal. Textures in
// formats other than PNG and JPEG are declared by the extensions that allow them (WebP, KTX2). Throws ResourceError for
// more than 4 GiB, which the format cannot hold.
[[nodiscard]] std::vector<std::byte> encode_glb(const MeshView& mesh);

}  // namespace lodestone
