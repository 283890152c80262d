// Spheres of any triangles: each component closed, oriented, manifold and of genus 0.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/spherical/surface.h"
#include "core/spherical/topology/handles.h"
#include "core/spherical/topology/manifold.h"
#include "core/spherical/topology/report.h"

namespace lodestone::spherical {

struct Spheres {
  std::vector<Surface> surfaces;  // is_sphere() is true for each; in the order of their first triangles
  TopologyReport report;
};

// The recipe: cut apart what does not fit together (manifold.h), take the components one by one, fill their holes
// (fill_holes.h) and close their handles (handles.h). Added triangles have no source, and close the surface only for
// the time of its mapping. The result does not depend on the runner. Memory: some 250 bytes per triangle. Throws
// ResourceError beyond 1.4 billion triangles.
[[nodiscard]] Spheres make_spheres(const IndexedMesh& mesh, const HandleConfig& config = {}, const Runner& runner = {});

}  // namespace lodestone::spherical
