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

#include "core/math/triangle.h"
#include "core/math/vec3.h"
#include "core/spherical/octahedron/octahedral_map.h"

namespace lodestone::spherical {

// n x n samples, n at most 32768. In cells: at the centres of n x n squares; on_sides: the first and last ones on the
// sides (n >= 2).
struct SampleGrid {
  enum class Placing : std::uint8_t { in_cells, on_sides };
  std::uint32_t n = 0;
  Placing placing = Placing::in_cells;

  [[nodiscard]] double coordinate(std::uint32_t i) const {
    return placing == Placing::in_cells ? (i + 0.5) / n : static_cast<double>(i) / (n - 1);
  }
  [[nodiscard]] SquarePoint place(std::uint32_t x, std::uint32_t y) const { return {coordinate(x), coordinate(y)}; }
};

inline constexpr std::uint32_t no_triangle = 0xFFFF'FFFFu;

// The samples [x, x + width) x [y, y + height), row by row.
struct SampleTile {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  std::array<std::vector<double>, 3> direction;  // components
  std::vector<std::uint32_t> triangle;           // no_triangle where the mesh leaves a hole
  std::array<std::vector<float>, 3> weight;      // barycentric, of sum 1; nothing without a triangle
};

class SphereRaster {
 public:
  static constexpr std::uint32_t tile_side = 64;  // samples

  // The triangles are counter-clockwise seen from outside, directions of unit length. Both must outlive the raster.
  SphereRaster(std::span<const Triangle> triangles, std::span<const Vec3d> directions, SampleGrid grid);

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
  [[nodiscard]] Box box_of(std::span<const SquarePoint> corners, double longest) const;
  void add_parts(std::uint32_t triangle);
  template <class Body>
  void for_each_tile(const Box& box, const Body& body) const;

  std::span<const Triangle> triangles_;
  std::span<const Vec3d> directions_;
  SampleGrid grid_;
  std::uint32_t tiles_ = 0;
  std::vector<SquarePoint> places_;  // by direction
  std::vector<Box> boxes_;           // by triangle, of those in a single octant
  std::vector<Part> parts_;
  std::vector<std::uint32_t> first_;       // by tile: of candidates_; one more at the end
  std::vector<std::uint32_t> candidates_;  // parts
};

}  // namespace lodestone::spherical
