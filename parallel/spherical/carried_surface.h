// The part of its input's materials that a surface over the sphere keeps, beside images of colours and normals.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "core/base/id.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// The number of a triangle's material, or no_material.
[[nodiscard]] std::uint32_t material_of(const IndexedMesh& mesh, TriangleId triangle);

// Which other images some materials need: those that one of them has, and those that say in which factors they differ.
struct MaterialMaps {
  bool metal_and_roughness = false, occlusion = false, emission = false;
};
[[nodiscard]] MaterialMaps material_maps(const IndexedMesh& mesh, const std::set<std::uint32_t>& materials);

// A material with the factors (metal, roughness, light of its own), the alpha mode and the extensions that all of
// `materials` have in common, which are numbers of the mesh's materials; the defaults where they differ. Factors are 1
// in the images that `drawn` names, which core/spherical/resample makes; those that other images multiply take their
// defaults. Adds a line to `left_out` for each feature that is lost.
[[nodiscard]] Material carried_surface(const IndexedMesh& mesh, const std::set<std::uint32_t>& materials,
                                       const MaterialMaps& drawn, std::set<std::string>& left_out);

}  // namespace lodestone
