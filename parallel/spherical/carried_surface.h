// The part of its input's materials that a surface over the sphere keeps: all but images.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "core/base/id.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// The number of a triangle's material, or no_material.
[[nodiscard]] std::uint32_t material_of(const IndexedMesh& mesh, TriangleId triangle);

// A material with the factors (metal, roughness, light of its own), the alpha mode and the extensions that all of
// `materials` have in common, which are numbers of the mesh's materials; the defaults where they differ. Their images
// of roughness, occlusion and light are not drawn anew: the factors that they multiply take their defaults. Adds a line
// to `left_out` for each feature that is lost.
[[nodiscard]] Material carried_surface(const IndexedMesh& mesh, const std::set<std::uint32_t>& materials,
                                       std::set<std::string>& left_out);

}  // namespace lodestone
