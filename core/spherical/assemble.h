// The mesh that octahedral images are drawn on: the input's own surface, without what filled its holes and closed its
// handles, with the coordinates of the square.
#pragma once

#include <span>

#include "core/mesh/indexed_mesh.h"
#include "core/spherical/octahedron/square_atlas.h"
#include "core/spherical/octahedron/unfold.h"
#include "core/spherical/surface.h"

namespace lodestone::spherical {

// Normalised as the input is: in model units its vertices would move if they are far from the origin. Each surface has
// its place in the textures of a material; materials and textures are left to the caller. Wedges have texture
// coordinates and the input's normals, or means of its triangles' by area where it has none; where the cut or a closed
// handle parts the texture, they belong to one vertex of the mesh once it is welded.
[[nodiscard]] RawMesh assemble(const IndexedMesh& input, std::span<const Surface> surfaces,
                               std::span<const Unfolding> unfoldings, std::span<const ImagePlace> places);

}  // namespace lodestone::spherical
