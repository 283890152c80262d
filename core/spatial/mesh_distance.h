// How far two surfaces are from each other, measured at sample points in both directions (as Metro does: Cignoni et al.
// 1998).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/spatial/surface_samples.h"
#include "core/spatial/triangle_bvh.h"

namespace lodestone {

struct CompareConfig {
  // Points spread over the area of each mesh; 0: four per triangle, at most 1,000,000, at least 10,000.
  std::uint64_t area_points = 0;
};

// Distances of the samples of one mesh from the surface of the other, in model units. `max` is taken over vertices and
// area points (a lower bound of the one-sided Hausdorff distance); the others over the area points alone, each of which
// stands for the same area, or over the vertices when the mesh has no area.
struct DirectedDistance {
  double max = 0, rms = 0, mean = 0;
  double p99 = 0;             // the least value that 99 % of the samples do not exceed
  std::uint64_t samples = 0;  // vertices and area points
};

struct MeshDistance {
  double diagonal = 0;        // of the bounding box of the first mesh: what errors are usually divided by
  DirectedDistance forward;   // from the first mesh to the second
  DirectedDistance backward;  // from the second mesh to the first
};

// Unreferenced vertices do not count. Throws InputError for a mesh without triangles or with a non-finite vertex.
// parallel/mesh/compare.h has the parallel twin, which gives the same bytes.
[[nodiscard]] MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config = {});

// The slow, obvious twin: every sample against every triangle. For tests.
[[nodiscard]] MeshDistance compare_meshes_brute_force(const RawMesh& a, const RawMesh& b,
                                                      const CompareConfig& config = {});

// The pieces that an orchestration puts together.

// Both meshes moved and scaled to about the unit cube: boxes are float, and coordinates may have a huge offset.
struct ComparedMesh {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};
struct ComparedPair {
  ComparedMesh mesh[2];
  double scale = 1;     // model units per unit
  double diagonal = 0;  // model units
};
[[nodiscard]] ComparedPair prepare_comparison(const RawMesh& a, const RawMesh& b);
[[nodiscard]] SurfaceSamples samples_of(const ComparedMesh& mesh, const CompareConfig& config);

// Squared distances of the samples [begin, end) from the mesh of `bvh` into out[begin, end). Each sample starts from
// the nearest triangle of the one before, so results are a function of the cut: orchestrations cut by sample_grain.
inline constexpr std::uint64_t sample_grain = 4096;
void measure_samples(const SurfaceSamples& samples, const TriangleBvh& bvh, std::uint64_t begin, std::uint64_t end,
                     std::span<double> out);

// Reorders `squared`, one per sample.
[[nodiscard]] DirectedDistance summarise(const SurfaceSamples& samples, std::span<double> squared, double scale);

}  // namespace lodestone
