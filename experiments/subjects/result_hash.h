// The content of results as numbers, to tell whether two of them are the same, byte for byte.
#pragma once

#include <cstdint>
#include <string>

#include "core/hierarchy/model/hierarchy.h"
#include "core/mesh/indexed_mesh.h"
#include "core/progressive/mesh/progressive_mesh.h"
#include "render/frame/image.h"

namespace lodestone {

// 16 hexadecimal digits.
[[nodiscard]] std::string to_hex(std::uint64_t hash);
// Hash of cells and payloads: everything that the builder decides.
[[nodiscard]] std::uint64_t hash_of(const Hierarchy& hierarchy);
[[nodiscard]] std::uint64_t hash_of(const ProgressiveMesh& mesh);  // positions, triangles, parents
[[nodiscard]] std::uint64_t hash_of(const RawMesh& mesh);          // positions, triangles
[[nodiscard]] std::uint64_t hash_of(const Image& image);           // colour

}  // namespace lodestone
