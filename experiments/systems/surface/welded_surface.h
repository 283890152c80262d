// The finest level of a model as one mesh, for systems that make levels of their own of it.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

struct WeldedSurface {
  std::vector<Vec3f> positions;  // normalised, one vertex at a place
  std::vector<PackedNormal> normals;
  std::vector<Triangle> triangles;
};

// Throws InputError that names the system for a model with attributes, which these systems do not draw.
[[nodiscard]] WeldedSurface welded_surface(const Hierarchy& model, std::string_view system);

// The same as an input of simplifiers.
[[nodiscard]] IndexedMesh indexed_mesh(const WeldedSurface& surface, const Transform& transform);

// The normals of vertices that lie where vertices of the surface lie, bit for bit.
[[nodiscard]] std::vector<PackedNormal> normals_at(const WeldedSurface& surface, std::span<const Vec3f> positions);

// Numbers of triangles so that those side by side are near each other: in the Morton order of their first corners.
[[nodiscard]] std::vector<std::uint32_t> coherent_order(std::span<const Vec3f> positions,
                                                        std::span<const Triangle> triangles);

}  // namespace lodestone
