// Sample points of a surface, and the steps in which two meshes are compared by them (core/spatial/mesh_distance.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/spatial/mesh_distance.h"
#include "core/spatial/triangle_bvh.h"

namespace lodestone {

// Points on a mesh at which distances are measured: its vertices, and points spread evenly over its area.
//
// Point k of n lies at the share (k + 1/2) / n of the area summed in file order, so each triangle gets its share to
// within one point; inside the triangle it is a point of the R2 low-discrepancy sequence (Roberts 2018). Everything is
// a function of the mesh and of k: no state, no random numbers.
class SurfaceSamples {
 public:
  // area_points: their number; 0 is used if the mesh has no area. Keeps a reference to both arguments.
  SurfaceSamples(std::span<const Vec3d> positions, std::span<const Triangle> triangles, std::uint64_t area_points);

  // The vertices that triangles use come first, then the area points.
  [[nodiscard]] std::uint64_t vertices() const { return used_.size(); }
  [[nodiscard]] std::uint64_t size() const { return used_.size() + area_points_; }

  // Samples [begin, end) into `out`, replacing its content. `triangles`: likewise, the triangle of each area point;
  // since vertices have none, begin must then be at least vertices().
  void take(std::uint64_t begin, std::uint64_t end, std::vector<Vec3d>& out,
            std::vector<std::uint32_t>* triangles = nullptr) const;

 private:
  [[nodiscard]] Vec3d point_in(const Triangle& triangle, std::uint64_t k) const;

  std::span<const Vec3d> positions_;
  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> used_;  // vertices of triangles, ascending
  std::vector<double> area_up_to_;   // inclusive prefix sums over the triangles
  std::uint64_t area_points_ = 0;
};

// The steps of a comparison of two meshes, for the serial and the parallel form.

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
// the nearest triangle of the one before, so results depend on the ranges: callers use ranges of sample_grain.
inline constexpr std::uint64_t sample_grain = 4096;
void measure_samples(const SurfaceSamples& samples, const TriangleBvh& bvh, std::uint64_t begin, std::uint64_t end,
                     std::span<double> out);

// `squared` has one value per sample and is reordered.
[[nodiscard]] DirectedDistance summarise(const SurfaceSamples& samples, std::span<double> squared, double scale);

}  // namespace lodestone
