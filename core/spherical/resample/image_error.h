// The error of octahedral images against the surface that they were made from, at points spread evenly over it.
#pragma once

#include <cstdint>
#include <span>

#include "core/spatial/mesh_distance.h"
#include "core/spatial/surface_samples.h"
#include "core/spherical/resample/surface_source.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

// Sums over samples; those of ranges are added up in the order of the ranges.
struct ImageErrorSums {
  double colour = 0;  // squared differences of red, green and blue in the sRGB encoding, 0 to 1
  double normal = 0;  // squared differences of x, y and z
  double angle = 0;   // degrees
  std::uint64_t samples = 0;
  std::uint64_t normals = 0;  // samples with a normal on both sides
  void add(const ImageErrorSums& other);
};

// Peak signal to noise ratios in dB: of colours over the range of a byte, of normals over the range from -1 to 1.
// 100 dB where there is no difference; 0 without samples.
struct ImageError {
  double colour_psnr = 0, normal_psnr = 0;
  double mean_angle = 0;      // between normals, degrees
  std::uint64_t samples = 0;  // on triangles that have a source
};

class ImageErrorMeter {
 public:
  // Images as a viewer has them, after decoding: `colour` with 4 or 3 channels of light (to_linear), `normal` with 3;
  // either may have no pixels. `points`: their number on the surface. All arguments must outlive the meter.
  ImageErrorMeter(const Surface& surface, std::span<const Vec3d> directions, const SurfaceSource& source,
                  std::uint64_t points);

  [[nodiscard]] std::uint64_t size() const { return samples_.size() - samples_.vertices(); }
  [[nodiscard]] ImageErrorSums measure(const LinearImage& colour, const LinearImage& normal, std::uint64_t begin,
                                       std::uint64_t end) const;

 private:
  const Surface& surface_;
  std::span<const Vec3d> directions_;
  const SurfaceSource& source_;
  SurfaceSamples samples_;
};

[[nodiscard]] ImageError image_error(const ImageErrorSums& sums);

// Points in a range of one call of measure(), for equal sums whatever runs side by side.
inline constexpr std::uint64_t error_grain = 16384;

// All points, range by range.
[[nodiscard]] ImageError measure_images(const ImageErrorMeter& meter, const LinearImage& colour,
                                        const LinearImage& normal);

}  // namespace lodestone::spherical
