#include "experiments/metrics/geometry/normal_deviation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/spatial/surface_samples.h"
#include "core/spatial/triangle_bvh.h"
#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {
namespace {

constexpr double no_angle = -1;

Vec3d normal_of(const ComparedMesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3d a = mesh.positions[t.v[0]];
  return cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a);
}

// Degrees; accurate for small angles, too.
double angle_between(Vec3d a, Vec3d b) {
  const double sine = length(cross(a, b)), cosine = dot(a, b);
  if (!(length(a) > 0) || !(length(b) > 0)) return no_angle;
  return std::atan2(sine, cosine) * (180 / std::numbers::pi);
}

DirectedDeviation summarise(std::vector<double>& angles) {
  std::erase(angles, no_angle);
  DirectedDeviation result;
  result.samples = angles.size();
  if (angles.empty()) return result;
  double sum = 0;
  for (const double a : angles) sum += a;
  const auto count = static_cast<double>(angles.size());
  result.mean = sum / count;
  result.max = *std::max_element(angles.begin(), angles.end());
  result.p99 = quantile(angles, 0.99);
  return result;
}

DirectedDeviation directed(const ComparedMesh& from, const ComparedMesh& to, const CompareConfig& config,
                           Scheduler& scheduler) {
  const SurfaceSamples samples = samples_of(from, config);
  const TriangleBvh bvh(to.positions, to.triangles);
  const std::uint64_t vertices = samples.vertices();
  std::vector<double> angles(samples.size() - vertices);
  scheduler.for_chunks(angles.size(), sample_grain, [&](ChunkRange range) {
    std::vector<Vec3d> points;
    std::vector<std::uint32_t> triangles;
    samples.take(vertices + range.begin, vertices + range.end, points, &triangles);
    std::uint32_t hint = TriangleBvh::no_hint;
    for (std::size_t i = 0; i < points.size(); ++i) {
      hint = bvh.nearest(points[i], hint).slot;
      angles[range.begin + i] = angle_between(normal_of(from, triangles[i]), normal_of(to, bvh.triangle(hint)));
    }
  });
  return summarise(angles);
}

}  // namespace

NormalDeviation normal_deviation(const RawMesh& a, const RawMesh& b, const CompareConfig& config,
                                 Scheduler& scheduler) {
  const ComparedPair pair = prepare_comparison(a, b);
  return {directed(pair.mesh[0], pair.mesh[1], config, scheduler),
          directed(pair.mesh[1], pair.mesh[0], config, scheduler)};
}

}  // namespace lodestone
