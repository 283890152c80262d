// Finds, for every sample of a grid over the octahedral square, the triangle of a mesh on the sphere that contains its
// direction, and where in the triangle it is, by central projection.
//
// The samples are tested by their directions against the planes through the edges and the centre: no triangle is
// clipped or bent, whatever the map to the square does with it. The square serves to find candidates: triangles are
// sorted into tiles of samples by boxes around their images. Two triangles at an edge see the same plane, with the
// same bits and opposite sign, so that no sample falls between them; on an edge or a vertex the first triangle has it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/math/vec3.h"
#include "core/spherical/octahedron/octahedral_map.h"
#include "core/spherical/octahedron/raster_kernel.h"

namespace lodestone::spherical {

class SphereRaster {
 public:
  // The triangles are counter-clockwise seen from outside, directions of unit length. Both must outlive the raster.
  SphereRaster(std::span<const Triangle> triangles, std::span<const Vec3d> directions, SampleGrid grid,
               InstructionSet instructions = InstructionSet::best);

  // The steps, in this order; those with a range may run side by side.
  void place(std::size_t begin, std::size_t end);  // of directions
  void bound(std::size_t begin, std::size_t end);  // of triangles
  void sort();
  // The samples of tile `index` into a tile whose memory is reused.
  void cover(std::size_t index, SampleTile& tile) const;

  // All three steps before cover().
  void prepare();

  [[nodiscard]] std::size_t tiles_per_side() const { return tiles_; }
  [[nodiscard]] std::size_t tile_count() const { return std::size_t{tiles_} * tiles_; }

 private:
  // Samples [left, right] x [top, bottom]; none if right < left.
  struct Box {
    std::uint16_t left = 1, right = 0, top = 0, bottom = 0;
  };
  // The part of a triangle in one octant.
  struct Part {
    Box box;
    std::uint32_t triangle = 0;
  };
  [[nodiscard]] Box box_of(std::span<const Vec3d> corners, std::span<const SquarePoint> places,
                           const Octant& octant) const;
  void add_parts(std::uint32_t triangle);
  template <class Body>
  void for_each_tile(const Box& box, const Body& body) const;

  std::span<const Triangle> triangles_;
  std::span<const Vec3d> directions_;
  SampleGrid grid_;
  const RasterKernel& kernel_;
  std::uint32_t tiles_ = 0;
  std::vector<SquarePoint> places_;  // by direction
  std::vector<Box> boxes_;           // by triangle, of those in a single octant
  std::vector<Part> parts_;
  std::vector<std::uint32_t> first_;       // by tile: of candidates_; one more at the end
  std::vector<std::uint32_t> candidates_;  // parts
};

}  // namespace lodestone::spherical
