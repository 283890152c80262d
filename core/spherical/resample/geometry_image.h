// A surface as an image of its positions over the octahedral square, and the regular mesh that the image is (gu2002).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/spherical/octahedron/sphere_raster.h"
#include "core/spherical/resample/octahedral_codec.h"
#include "core/spherical/surface.h"

namespace lodestone::spherical {

// n x n positions, the first and last on the sides of the square: mirrored samples on a side are the same point.
struct GeometryImage {
  std::uint32_t n = 0;
  std::vector<Vec3d> positions;  // row by row
};

// Samples the surface. n is odd, 3 to 32767: the middles of the sides, where the cut ends, are samples. n = 2^k + 1
// gives levels by every second sample. Throws InputError for other n, and if the surface leaves a sample uncovered.
class GeometrySampler {
 public:
  GeometrySampler(const Surface& surface, std::span<const Vec3d> directions, std::uint32_t n);
  [[nodiscard]] SphereRaster& raster() { return raster_; }
  void draw(std::size_t tile, SampleTile& room);
  [[nodiscard]] GeometryImage finish();

 private:
  const Surface& surface_;
  SphereRaster raster_;
  GeometryImage image_;
  std::vector<std::uint8_t> covered_;
};
// All steps, one after the other.
[[nodiscard]] GeometryImage sample_geometry(const Surface& surface, std::span<const Vec3d> directions, std::uint32_t n);

// 16 bits per component over the box of the positions: position = origin + step * value.
struct WideGeometry {
  WideImage image;
  Vec3d origin;
  double step = 1;  // the same along all axes
};
[[nodiscard]] WideGeometry wide_geometry(const GeometryImage& image);
[[nodiscard]] GeometryImage geometry_of(const WideGeometry& wide);

// The mesh over the samples: two triangles per square, divided by the shorter diagonal except at the ends of the
// cut, closed across the sides of the
// image. Each point is a vertex once: (n - 1)^2 + 2 of them.
[[nodiscard]] RawMesh remesh(const GeometryImage& image);

}  // namespace lodestone::spherical
