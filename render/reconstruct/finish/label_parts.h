// Properties of a whole mesh: its parts that share no vertex, its handles and its border.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A number for each triangle, equal within a part; all parts of less than `least_share` of the triangles together have
// number 0: many small pieces are seen as one surface. Empty if the mesh is one part.
[[nodiscard]] std::vector<std::uint32_t> label_parts(const IndexedMesh& mesh, double least_share = 0.01);

// Number of handles of the surface, summed over its components; fans that meet in a vertex count as separate. Empty if
// an edge has more than two triangles, or two with different orientations.
[[nodiscard]] std::optional<std::size_t> count_handles(const IndexedMesh& mesh);

// Points on the border edges of the mesh, at most `spacing` apart (normalised units), both ends included.
[[nodiscard]] std::vector<Vec3f> border_points(const IndexedMesh& mesh, double spacing);

}  // namespace lodestone
