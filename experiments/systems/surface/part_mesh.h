// A part of a surface as a mesh of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// Triangles of a part of a surface: `vertices` are those of the surface, ascending, `triangles` places among them.
struct PartMesh {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3f> positions;  // of `vertices`
  std::vector<Triangle> triangles;
};

// Triangles have vertices of the surface.
[[nodiscard]] PartMesh part_mesh(std::span<const Triangle> triangles, std::span<const Vec3f> surface);

}  // namespace lodestone
