// Properties of a whole mesh: its parts that share no vertex, its handles and its border.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "render/reconstruct/seams/model_border.h"

namespace lodestone {

// A number for each triangle, equal within a part; all parts of less than `least_share` of the triangles together have
// number 0: many small pieces are seen as one surface. Empty if the mesh is one part.
[[nodiscard]] std::vector<std::uint32_t> label_parts(const IndexedMesh& mesh, double least_share = 0.01);

// Number of handles of the surface, summed over its components; fans that meet in a vertex count as separate. Empty if
// an edge has more than two triangles, or two with different orientations.
[[nodiscard]] std::optional<std::size_t> count_handles(const IndexedMesh& mesh);

// Edges of one triangle, in the order of the triangles: from this corner of it to the next.
struct LoneEdge {
  std::uint32_t triangle = 0, corner = 0;
};
[[nodiscard]] std::vector<LoneEdge> border_edges(const IndexedMesh& mesh);
// Points on them, so that each place on them has one at most `spacing` away (normalised units) that faces as it does.
// Memory and time follow the space that the border goes through where it is crowded, not its length.
[[nodiscard]] std::vector<BorderPoint> border_points(const IndexedMesh& mesh, std::span<const LoneEdge> border,
                                                     double spacing);
// The smallest mean width of a part, in normalised units: twice its area over the length of its border, which is that
// of a strip. `parts`: as label_parts() has them, number 0 and parts of less than 1 % of the area apart. Infinite if no
// part has a border.
[[nodiscard]] double narrowest_width(const IndexedMesh& mesh, std::span<const std::uint32_t> parts,
                                     std::span<const LoneEdge> border);

}  // namespace lodestone
