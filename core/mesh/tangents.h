// Tangents of a mesh with normals and texture coordinates: the axes of normal maps in tangent space.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/attributes.h"

namespace lodestone {

// One per wedge: the mean of the directions of the triangles around it, each in the plane of the normal and weighted by
// the angle at the corner (mikkelsen2008). Components are multiples of 2^-10: files compress them well, and what is
// made with these tangents is read with the same. Triangles are in the order of their wedges; arrays have one value per
// wedge.
[[nodiscard]] std::vector<Tangent> tangents_of(std::span<const Triangle> triangles, std::span<const Vec3f> positions,
                                               std::span<const Vec2f> uv, std::span<const Vec3f> normals);

}  // namespace lodestone
