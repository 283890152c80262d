// Colours and normals of a surface as octahedral images, by supersampling.
//
// Each pixel has sides x sides samples, placed by core/spherical/octahedron/sphere_raster.h. Samples of one chart share
// a footprint over the whole pixel, and are filtered from their textures once, row by row, so that the texels of many
// pixels are fetched at a time; samples on both sides of a border between
// charts are filtered apart, each over its own part of the pixel. Light is averaged with its alpha as weight, normals
// as vectors. Pixels of which no sample has a source, at filled holes, get the mean of their neighbours, ring by ring.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/spherical/octahedron/sphere_raster.h"
#include "core/spherical/resample/pixel_row.h"
#include "core/spherical/resample/surface_source.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

struct ResampleConfig {
  std::uint32_t size = 1024;  // pixels along a side; at least 1, size * sides at most 32768
  std::uint32_t sides = 2;    // samples along a pixel's side: 2, 4, 8
  bool colours = true;        // false: an image without pixels
  bool normals = true;        // likewise
};

// Both symmetric (octahedron/octahedral_image.h); either has no pixels if it is not wanted.
struct ResampledImages {
  LinearImage colour;        // 4 channels: light times alpha, and alpha
  LinearImage normal;        // 3 channels, of unit length, at the sides of at most that, zero if unknown
  std::uint64_t filled = 0;  // pixels without a sample that has a source
};

class Resampler {
 public:
  // All arguments must outlive it; the source's textures are loaded. Throws InputError for sizes out of range.
  Resampler(const Surface& surface, std::span<const Vec3d> directions, const SurfaceSource& source,
            const ResampleConfig& config);

  // The steps of the raster (place, bound, sort) come first.
  [[nodiscard]] SphereRaster& raster() { return raster_; }
  // One tile of the raster, whose memory is reused; tiles may run side by side.
  void draw(std::size_t tile, SampleTile& room);
  [[nodiscard]] ResampledImages finish();

 private:
  struct Row;
  void add_up(Row& row) const;
  void add_normals(Row& row) const;
  void set(const Row& row, std::size_t first, std::size_t count);
  void fill();

  const SurfaceSource& source_;
  ResampleConfig config_;
  SphereRaster raster_;
  ResampledImages images_;
  std::vector<std::uint8_t> covered_;
};

// All steps, one after the other.
[[nodiscard]] ResampledImages resample(const Surface& surface, std::span<const Vec3d> directions,
                                       const SurfaceSource& source, const ResampleConfig& config);

}  // namespace lodestone::spherical
