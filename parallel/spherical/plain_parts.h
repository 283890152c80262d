// Components of so few triangles that their vertices say all that octahedral images would show.
#pragma once

#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/spherical/octahedron/unfold.h"
#include "core/spherical/surface.h"
#include "parallel/spherical/make_spherical.h"

namespace lodestone {

// Takes them out of `surfaces`, in their order, and returns them as one surface, open, with what the input has of them
// alone. They have at most eight triangles of the input, which has neither textures nor colours at its vertices nor
// several materials, and are many: their images would be most of the result, and of the time. Empty if there are few,
// or each component is to have a geometry image.
[[nodiscard]] spherical::Surface take_plain_parts(const IndexedMesh& mesh, const SphericalMaps& maps,
                                                  std::vector<spherical::Surface>& surfaces);

// All triangles as they are, in one point of the square.
[[nodiscard]] spherical::Unfolding plain_unfolding(const spherical::Surface& surface);

}  // namespace lodestone
