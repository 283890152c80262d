#include "core/spatial/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/math/box3.h"

namespace lodestone {
namespace {

// Of the vertices that triangles use.
Box3d box_of(const RawMesh& mesh, const char* which) {
  if (mesh.triangles.empty())
    throw InputError(describe("", std::string(which) + " mesh", "has no triangles", "there is no surface to compare"));
  Box3d box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t.v) {
      if (!is_finite(mesh.positions[v]))
        throw InputError(describe("", std::string(which) + " mesh, vertex " + std::to_string(v), "is not finite",
                                  "clean the mesh first"));
      box.extend(mesh.positions[v]);
    }
  return box;
}

ComparedMesh moved(const RawMesh& mesh, Vec3d origin, double scale) {
  ComparedMesh result{{}, mesh.triangles};
  result.positions.reserve(mesh.positions.size());
  for (const Vec3d p : mesh.positions)
    result.positions.push_back(is_finite(p) ? (1 / scale) * (p - origin) : Vec3d{});  // unreferenced ones may be wild
  return result;
}

template <typename Measure>
DirectedDistance measure_all(const SurfaceSamples& samples, double scale, Measure&& measure) {
  std::vector<double> squared(samples.size());
  for (std::uint64_t begin = 0; begin < samples.size(); begin += sample_grain)
    measure(begin, std::min(begin + sample_grain, samples.size()), squared);
  return summarise(samples, squared, scale);
}

}  // namespace

ComparedPair prepare_comparison(const RawMesh& a, const RawMesh& b) {
  const Box3d box_a = box_of(a, "first"), box_b = box_of(b, "second");
  Box3d both = box_a;
  both.extend(box_b.lo);
  both.extend(box_b.hi);
  const Vec3d extent = both.hi - both.lo;
  const double scale = std::max({extent.x, extent.y, extent.z});
  ComparedPair pair;
  pair.scale = scale > 0 ? scale : 1;
  if (!std::isfinite(pair.scale))
    throw InputError(describe("", "", "the meshes together are larger than double precision holds", "scale them down"));
  pair.diagonal = pair.scale * length((1 / pair.scale) * (box_a.hi - box_a.lo));
  pair.mesh[0] = moved(a, both.lo, pair.scale);
  pair.mesh[1] = moved(b, both.lo, pair.scale);
  return pair;
}

SurfaceSamples samples_of(const ComparedMesh& mesh, const CompareConfig& config) {
  const std::uint64_t by_size = std::clamp<std::uint64_t>(4 * mesh.triangles.size(), 10'000, 1'000'000);
  return {mesh.positions, mesh.triangles, config.area_points == 0 ? by_size : config.area_points};
}

void measure_samples(const SurfaceSamples& samples, const TriangleBvh& bvh, std::uint64_t begin, std::uint64_t end,
                     std::span<double> out) {
  std::vector<Vec3d> points;
  samples.take(begin, end, points);
  std::uint32_t hint = TriangleBvh::no_hint;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TriangleBvh::Nearest nearest = bvh.nearest(points[i], hint);
    out[begin + i] = nearest.squared_distance;
    hint = nearest.slot;
  }
}

DirectedDistance summarise(const SurfaceSamples& samples, std::span<double> squared, double scale) {
  DirectedDistance result;
  result.samples = squared.size();
  result.max = scale * std::sqrt(*std::max_element(squared.begin(), squared.end()));
  std::span<double> counted = squared.subspan(samples.vertices());
  if (counted.empty()) counted = squared;
  double sum = 0, sum_of_squares = 0;
  for (const double s : counted) {
    sum += std::sqrt(s);
    sum_of_squares += s;
  }
  const auto count = static_cast<double>(counted.size());
  result.mean = scale * (sum / count);
  result.rms = scale * std::sqrt(sum_of_squares / count);
  const auto at = counted.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.99 * count)) - 1;
  std::nth_element(counted.begin(), at, counted.end());
  result.p99 = scale * std::sqrt(*at);
  return result;
}

MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config) {
  const ComparedPair pair = prepare_comparison(a, b);
  const auto directed = [&](const ComparedMesh& from, const ComparedMesh& to) {
    const SurfaceSamples samples = samples_of(from, config);
    const TriangleBvh bvh(to.positions, to.triangles);
    return measure_all(samples, pair.scale, [&](std::uint64_t begin, std::uint64_t end, std::span<double> out) {
      measure_samples(samples, bvh, begin, end, out);
    });
  };
  return {pair.diagonal, directed(pair.mesh[0], pair.mesh[1]), directed(pair.mesh[1], pair.mesh[0])};
}

MeshDistance compare_meshes_brute_force(const RawMesh& a, const RawMesh& b, const CompareConfig& config) {
  const ComparedPair pair = prepare_comparison(a, b);
  const auto directed = [&](const ComparedMesh& from, const ComparedMesh& to) {
    const SurfaceSamples samples = samples_of(from, config);
    return measure_all(samples, pair.scale, [&](std::uint64_t begin, std::uint64_t end, std::span<double> out) {
      std::vector<Vec3d> points;
      samples.take(begin, end, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (const Triangle& t : to.triangles)
          least = std::min(
              least, nearest_on_triangle(points[i], to.positions[t.v[0]], to.positions[t.v[1]], to.positions[t.v[2]])
                         .squared_distance);
        out[begin + i] = least;
      }
    });
  };
  return {pair.diagonal, directed(pair.mesh[0], pair.mesh[1]), directed(pair.mesh[1], pair.mesh[0])};
}

}  // namespace lodestone
