// What a mesh as a whole tells: its parts that share no vertex, and where it ends.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A number for each triangle, equal within a part; all parts of less than `least_share` of the triangles together are
// number 0: what is torn into many pieces is one surface to whoever looks at it. Empty when all is one part.
[[nodiscard]] std::vector<std::uint32_t> label_parts(const IndexedMesh& mesh, double least_share = 0.01);

// Handles of the surface, of all its components together; where fans meet in a vertex they are apart. Nothing where an
// edge has more than two triangles, or two that face different ways.
[[nodiscard]] std::optional<std::size_t> count_handles(const IndexedMesh& mesh);

// Points on the border edges of the mesh, at most `spacing` apart (normalised units), both ends included.
[[nodiscard]] std::vector<Vec3f> border_points(const IndexedMesh& mesh, double spacing);

}  // namespace lodestone
