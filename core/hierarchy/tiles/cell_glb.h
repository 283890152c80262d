// One cell as binary glTF: the content of a tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// The URI of a texture as the level shows it, seen from the file; an index in Hierarchy::textures.
using TextureUri = std::function<std::string(std::uint32_t texture)>;

// Positions are those of the cell, bit for bit: inside the unit cube, z up. The matrix of the one node scales them to
// the model's size around its origin and turns them y up, as glTF has it; copies of a vertex in several cells meet
// under the same matrix. Vertices that no triangle uses are left out. Materials are those that the cell uses, textures
// are linked. `morph` adds what each vertex's parent has as attributes (but for the root): _PARENT and _PARENTNORMAL,
// in the same coordinates, _PARENTTEXCOORD and _PARENTCOLOR. The cell has triangles.
[[nodiscard]] std::vector<std::byte> encode_cell_glb(const Hierarchy& hierarchy, std::uint32_t cell, bool morph,
                                                     const TextureUri& texture_uri);

}  // namespace lodestone
