// Points on a mesh at which distances are measured: its vertices, and points spread evenly over its area.
//
// Point k of n stands at the share (k + 1/2) / n of the area summed in file order, so each triangle gets its share to
// within one point; inside the triangle it stands at a point of the R2 low-discrepancy sequence (Roberts 2018).
// Everything is a function of the mesh and of k: no state, no random numbers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

class SurfaceSamples {
 public:
  // area_points: how many; none when the mesh has no area. Keeps a reference to both arguments.
  SurfaceSamples(std::span<const Vec3d> positions, std::span<const Triangle> triangles, std::uint64_t area_points);

  // The vertices that triangles use come first, then the area points.
  [[nodiscard]] std::uint64_t vertices() const { return used_.size(); }
  [[nodiscard]] std::uint64_t size() const { return used_.size() + area_points_; }

  // Samples [begin, end) into `out`, replacing what it holds. `triangles`: likewise, which triangle each area point
  // lies on; area points alone have one, so that begin must not be less than vertices() then.
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

}  // namespace lodestone
