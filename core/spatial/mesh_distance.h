// Distance of two surfaces from each other, measured at sample points in both directions (as Metro does: Cignoni et al.
// 1998).
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct CompareConfig {
  // Points spread over the area of each mesh; 0: four per triangle, at most 1,000,000, at least 10,000.
  std::uint64_t area_points = 0;
};

// Distances of the samples of one mesh from the surface of the other, in model units. `max` is taken over vertices and
// area points (a lower bound of the one-sided Hausdorff distance); the others over the area points alone, each of which
// represents the same area, or over the vertices when the mesh has no area.
struct DirectedDistance {
  double max = 0, rms = 0, mean = 0;
  double p99 = 0;             // the smallest value that 99 % of the samples do not exceed
  std::uint64_t samples = 0;  // vertices and area points
};

struct MeshDistance {
  double diagonal = 0;        // of the bounding box of the first mesh; errors are usually divided by it
  DirectedDistance forward;   // from the first mesh to the second
  DirectedDistance backward;  // from the second mesh to the first
};

// Unreferenced vertices do not count. Throws InputError for a mesh without triangles or with a non-finite vertex.
// parallel/mesh/compare.h has the parallel twin, which gives the same bytes.
[[nodiscard]] MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config = {});

// The slow, simple twin for tests: every sample against every triangle.
[[nodiscard]] MeshDistance compare_meshes_brute_force(const RawMesh& a, const RawMesh& b,
                                                      const CompareConfig& config = {});

}  // namespace lodestone
