// Joins raw meshes: the parts of a scene, the tiles of a set.
#pragma once

#include <span>

#include "core/math/affine.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Appends the triangles, attributes, counts and warnings of `part` to those of `mesh`; vertices are not merged.
// An attribute that only one of them has gets its absent value in the other (RawWedges). Equal materials and textures
// become one. The materials of a part that brings none of its own are those of `mesh`. Throws ResourceError, naming
// `name`, for more vertices or wedges than 32-bit ids reach.
void append_mesh(RawMesh& mesh, RawMesh&& part, const std::string& name);

// The box of those that are finite.
[[nodiscard]] Box3d finite_box(std::span<const Vec3d> positions);

// Maps positions and normals; triangles of a mirrored mesh are reversed, so that the outside is kept.
void transform_mesh(RawMesh& mesh, const Affine3d& map);

// Positions, in the space of the model, and triangles; attributes are left out.
[[nodiscard]] RawMesh in_model_space(const IndexedMesh& mesh);

// The direction with unit length; zero if it has none.
[[nodiscard]] Vec3f unit_normal(Vec3d direction);

}  // namespace lodestone
