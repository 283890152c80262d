// Progressive meshes in binary glTF 2.0, which every viewer shows at full resolution.
//
// One vertex buffer in the order in which vertices come in, with _PARENTINDEX and _ERROR (in units of the model) as
// attributes of its own, and a primitive per material, triangles in the order in which they come in. `extras` of the
// mesh hold the number of vertices of the base, and whether images are octahedral. A node takes normalised positions to
// the model. `extras` of a material may name textures, as a textureInfo of the specification does: objectNormalTexture
// holds normals in object space, which a viewer of levels uses instead of the normals of vertices and the normal map
// that other viewers use; geometryImageTexture, with `origin` and `step`, holds positions (GeometryTexture). `extras`
// of a texture may have a thumbnail, its bufferView and mimeType; images that have one come last, so that a model is
// drawn before they arrive.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

// `compressed`: by EXT_meshopt_compression, without loss. `thumbnails`: those of make_thumbnails(), or empty. Throws
// ResourceError for more than 2^24 vertices, beyond which glTF has no number for a parent, and for more than 4 GiB.
[[nodiscard]] std::vector<std::byte> encode_progressive_glb(const ProgressiveMesh& mesh, bool compressed,
                                                            std::span<const Texture> thumbnails = {});

// Reads what encode_progressive_glb() wrote, bit for bit, without the thumbnails; the error of the finest level, which
// is stored in units of the model, may be rounded up. Throws InputError with the place for
// anything else, also for glTF without parents.
[[nodiscard]] ProgressiveMesh read_progressive_glb(ByteReader& input);

}  // namespace lodestone
