// One whole level of a hierarchy as a mesh, for export and for measuring distances, and the textures that it shows: the
// finest level those of the model, each coarser one copies of half the width and height, as far as there are copies.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// M_l in model space (double): the copies of a shared vertex in several cells become one vertex, vertices without
// a triangle are left out, triangles come cell by cell. Level 0 is the root, hierarchy.finest() the input up to the
// order of its vertices and triangles. With attributes the vertices of the result are wedges: `wedges` has one value of
// each attribute per vertex, normals included, and a material per triangle; textures are those that the level shows.
// Throws InputError when there is no such level, ResourceError when the level has more vertices than 32 bits count.
[[nodiscard]] RawMesh level_mesh(const Hierarchy& hierarchy, int level);

// Minimum side of a copy: smaller images are hardly smaller than their headers.
inline constexpr std::uint32_t min_texture_side = 32;

// Copies of one texture for at most `count` coarser levels and down to min_texture_side; by halve() of
// core/texture/downsample.h, each from the one before (before it was encoded), as colours, or as normals when materials
// use it as a normal map only. Throws what decode_image and encode_image throw.
[[nodiscard]] std::vector<TextureCopy> make_texture_copies(const Hierarchy& hierarchy, std::uint32_t texture,
                                                           int count);

// The copy of a texture that a level shows; nullptr: the texture itself.
[[nodiscard]] const TextureCopy* texture_copy(const Hierarchy& hierarchy, std::uint32_t texture, int level);

// All textures as this level shows them.
[[nodiscard]] std::vector<Texture> level_textures(const Hierarchy& hierarchy, int level);

}  // namespace lodestone
