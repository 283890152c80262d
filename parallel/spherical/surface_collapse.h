// The way from a surface to a tetrahedron, to be gone back.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/math/lanes/double4.h"
#include "core/spherical/parameterize/split_schedule.h"
#include "parallel/progressive/region_collapse.h"

namespace lodestone {

// Collapses are ordered by one of these: the quadric error of a progressive mesh, or the number of neighbours.
enum class CollapseBy : std::uint8_t { shape, connectivity };

// Vertices are numbered along a curve that fills space, so that neighbours are close in memory.
class SurfaceCollapse {
 public:
  // Throws InputError unless the surface is what map_to_sphere asks for.
  SurfaceCollapse(std::span<const Vec3d> positions, std::span<const Triangle> triangles, CollapseBy collapse_by,
                  InstructionSet instructions, Scheduler& scheduler);

  [[nodiscard]] std::span<const std::uint32_t> sources() const { return sources_; }  // by vertex: that of the input
  [[nodiscard]] progressive::RingMesh& rings() { return collapse_->rings(); }
  // The vertices of the tetrahedron, and how the others went.
  [[nodiscard]] std::span<const progressive::Id> base() const { return base_; }
  [[nodiscard]] std::span<const spherical::VertexSplit> collapses() const { return collapses_; }
  [[nodiscard]] std::size_t by_connectivity() const { return by_connectivity_; }

 private:
  void number(std::span<const Vec3d> positions);
  void check_rings(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

  ProgressiveConfig config_;
  Scheduler& scheduler_;
  IndexedMesh mesh_;
  std::vector<std::uint32_t> sources_, numbers_;
  std::unique_ptr<RegionCollapse> collapse_;
  progressive::RingArena arena_;
  std::vector<spherical::VertexSplit> collapses_;
  std::vector<progressive::Id> base_;
  std::size_t by_connectivity_ = 0;
};

}  // namespace lodestone
