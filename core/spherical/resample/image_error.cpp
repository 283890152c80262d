#include "core/spherical/resample/image_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/spatial/point_triangle.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/texture/colour.h"

namespace lodestone::spherical {
namespace {

std::array<double, 3> encoded(double r, double g, double b, double alpha) {
  const double scale = alpha > 0 ? 1 / alpha : 0;
  const auto value = [&](double v) { return linear_to_srgb(std::clamp(v * scale, 0.0, 1.0)); };
  return {value(r), value(g), value(b)};
}

double psnr(double mean_square) { return mean_square > 1e-10 ? -10 * std::log10(mean_square) : 100; }

}  // namespace

void ImageErrorSums::add(const ImageErrorSums& other) {
  colour += other.colour, normal += other.normal, angle += other.angle;
  samples += other.samples, normals += other.normals;
}

ImageErrorMeter::ImageErrorMeter(const Surface& surface, std::span<const Vec3d> directions, const SurfaceSource& source,
                                 std::uint64_t points)
    : surface_(surface),
      directions_(directions),
      source_(source),
      samples_(surface.positions, surface.triangles, points) {}

ImageErrorSums ImageErrorMeter::measure(const LinearImage& colour, const LinearImage& normal, std::uint64_t begin,
                                        std::uint64_t end) const {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles;
  samples_.take(samples_.vertices() + begin, samples_.vertices() + end, points, &triangles);
  ImageErrorSums sums;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t t = triangles[i];
    if (!source_.has(t)) continue;
    const auto [a, b, c] = surface_.triangles[t].v;
    const std::array<double, 3> w =
        barycentric(points[i], surface_.positions[a], surface_.positions[b], surface_.positions[c]);
    const SquarePoint place = square_point(w[0] * directions_[a] + (w[1] * directions_[b] + w[2] * directions_[c]));
    const SurfacePoint point{t, {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2])}};
    const Footprint footprint{source_.uv(point), {}, {}};
    ++sums.samples;
    if (!colour.values.empty()) {
      const Float4 light = source_.colour(point, footprint);
      const std::array<float, 4> shown = sample(colour, place);
      const std::array<double, 3> is = encoded(light[0], light[1], light[2], light[3]),
                                  was = encoded(shown[0], shown[1], shown[2], colour.channels == 4 ? shown[3] : 1);
      for (std::size_t k = 0; k < 3; ++k) sums.colour += (is[k] - was[k]) * (is[k] - was[k]);
    }
    if (normal.values.empty()) continue;
    const std::array<float, 4> vector = sample(normal, place);
    const Vec3d n = to_double(source_.normal(point, footprint)), m{vector[0], vector[1], vector[2]};
    const double size = length(m);
    if (!(size > 0) || n == Vec3d{}) continue;
    const Vec3d difference = n - (1 / size) * m;
    const double square = dot(difference, difference);
    sums.normal += square;
    sums.angle += 2 * std::asin(std::min(0.5 * std::sqrt(square), 1.0)) * (180 / std::numbers::pi);
    ++sums.normals;
  }
  return sums;
}

ImageError image_error(const ImageErrorSums& sums) {
  ImageError error;
  error.samples = sums.samples;
  if (sums.samples > 0) error.colour_psnr = psnr(sums.colour / (3 * static_cast<double>(sums.samples)));
  if (sums.normals == 0) return error;
  const auto count = static_cast<double>(sums.normals);
  error.normal_psnr = psnr(sums.normal / 4 / (3 * count));
  error.mean_angle = sums.angle / count;
  return error;
}

ImageError measure_images(const ImageErrorMeter& meter, const LinearImage& colour, const LinearImage& normal) {
  ImageErrorSums sums;
  for (std::uint64_t begin = 0; begin < meter.size(); begin += error_grain)
    sums.add(meter.measure(colour, normal, begin, std::min(begin + error_grain, meter.size())));
  return image_error(sums);
}

}  // namespace lodestone::spherical
