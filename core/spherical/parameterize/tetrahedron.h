// The ends of the way down: what is left of a surface after its collapses becomes a tetrahedron, whatever its shape.
#pragma once

#include <span>
#include <vector>

#include "core/math/lanes/double4.h"
#include "core/progressive/collapse/ring_mesh.h"
#include "core/spherical/parameterize/split_schedule.h"

namespace lodestone::spherical {

// Collapses further, by connectivity alone: vertices of few neighbours first, of these short edges. Appends what it did
// to `splits`. Every closed surface of genus 0 that is connected ends as a tetrahedron (steinitz1934). Returns the
// vertices that are left, four or, of another surface, more.
[[nodiscard]] std::vector<Id> collapse_to_tetrahedron(progressive::RingMesh& rings, std::vector<VertexSplit>& splits,
                                                      progressive::RingArena& arena);

// A regular tetrahedron for the four vertices, on the side that their rings are seen from.
void place_tetrahedron(const progressive::RingMesh& rings, std::span<const Id> vertices,
                       std::span<AlignedPoint4d> directions);

}  // namespace lodestone::spherical
