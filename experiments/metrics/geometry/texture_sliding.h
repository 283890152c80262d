// The distance by which a texture slides over the surface between two levels of a progressive mesh.
//
// The texture deviation (cohen1998) of a point of the finer level is its distance from the point of the coarser level
// that has the same texture coordinates, and thus shows the same place of the image. It is measured at points spread
// evenly over the area of the finer level, in texels of what is drawn: the coarser level is seen from where its error
// is one pixel. Graphics hardware takes the mip level there whose texels are as wide as a pixel, or the image itself
// where its texels are wider. A texel of the image is as wide as the square root of its area on the triangle.
//
// If several triangles of the coarser level contain the texture coordinates (a texture that repeats, a fold), the nearest
// point counts. If none does, since borders of charts have moved, the point is left out, and its share is reported.
#pragma once

#include <cstdint>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

struct TextureSliding {
  double mean = 0, max = 0;              // texels as drawn
  double image_mean = 0, image_max = 0;  // texels of the images, however far away
  std::uint64_t points = 0;
  double left_out = 0;  // share of the points
};

struct SlidingConfig {
  std::uint64_t points = 20'000;
  std::uint32_t texture_size = 1024;  // texels a side of a material without an image
};

// From the level of `fine` vertices to that of `coarse`, both as LevelFinder has them. Throws InputError for a mesh
// without texture coordinates.
[[nodiscard]] TextureSliding texture_sliding(const ProgressiveMesh& mesh, std::uint32_t coarse, std::uint32_t fine,
                                             const SlidingConfig& config = {});

// The largest means and maxima from the finest level to so many coarser ones, each of a fourth of the vertices of the
// one before; and from level to level where a slider steps: to each of them from one of a fourth more vertices.
struct SlidingOfLevels {
  TextureSliding whole, step;
};
[[nodiscard]] SlidingOfLevels texture_sliding_of_levels(const ProgressiveMesh& mesh, std::uint32_t levels);

}  // namespace lodestone
