// Texture coordinates, colours and normals for a mesh that was made of position maps.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

inline constexpr std::uint32_t no_source = 0xFFFF'FFFFu;

// `source`: for each vertex of `mesh`, the triangle of `from` that its pixel saw, or no_source. A vertex takes the
// values of the surface has at the place nearest to it around there. A triangle across a seam of the texture is given
// to the chart of two of its corners, and all of them take their values from within it, so that texture never runs
// backwards through an atlas nor out of a chart; vertices on seams have several wedges, then. Vertices beside a seam
// are moved onto it, within the surface, where the triangles around them allow it: the seam of the mesh is as straight
// as that of the source. Materials and textures are those of `from`. `mesh` is in the space of the model; its wedges
// are replaced. A vertex without source gets that of a neighbour.
void resample_attributes(const IndexedMesh& from, std::vector<std::uint32_t> source, RawMesh& mesh);

// One vertex per wedge, for files that know no other way: positions repeat.
[[nodiscard]] RawMesh split_wedges(const RawMesh& mesh);

}  // namespace lodestone
