#include "core/spatial/mesh_distance.h"

#include <algorithm>
#include <limits>

#include "core/spatial/surface_samples.h"

namespace lodestone {
namespace {

// measure_to(mesh) returns a function that measures samples [begin, end) from the mesh, as measure_samples does.
template <class MeasureTo>
MeshDistance compare(const RawMesh& a, const RawMesh& b, const CompareConfig& config, const MeasureTo& measure_to) {
  const ComparedPair pair = prepare_comparison(a, b);
  const auto directed = [&](const ComparedMesh& from, const ComparedMesh& to) {
    const SurfaceSamples samples = samples_of(from, config);
    const auto measure = measure_to(to);
    std::vector<double> squared(samples.size());
    for (std::uint64_t begin = 0; begin < samples.size(); begin += sample_grain)
      measure(samples, begin, std::min(begin + sample_grain, samples.size()), squared);
    return summarise(samples, squared, pair.scale);
  };
  return {pair.diagonal, directed(pair.mesh[0], pair.mesh[1]), directed(pair.mesh[1], pair.mesh[0])};
}

}  // namespace

MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config) {
  return compare(a, b, config, [](const ComparedMesh& mesh) {
    return [bvh = TriangleBvh(mesh.positions, mesh.triangles)](const SurfaceSamples& samples, std::uint64_t begin,
                                                               std::uint64_t end, std::span<double> out) {
      measure_samples(samples, bvh, begin, end, out);
    };
  });
}

MeshDistance compare_meshes_brute_force(const RawMesh& a, const RawMesh& b, const CompareConfig& config) {
  return compare(a, b, config, [](const ComparedMesh& mesh) {
    return [&mesh](const SurfaceSamples& samples, std::uint64_t begin, std::uint64_t end, std::span<double> out) {
      const auto& p = mesh.positions;
      std::vector<Vec3d> points;
      samples.take(begin, end, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (const Triangle& t : mesh.triangles)
          least = std::min(least, nearest_on_triangle(points[i], p[t.v[0]], p[t.v[1]], p[t.v[2]]).squared_distance);
        out[begin + i] = least;
      }
    };
  });
}

}  // namespace lodestone
