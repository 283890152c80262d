#include "core/spatial/surface_samples.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/error.h"
#include "core/math/vec3.h"

namespace lodestone {
namespace {

// Box of the vertices that triangles use.
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
    result.positions.push_back(is_finite(p) ? (1 / scale) * (p - origin)
                                            : Vec3d{});  // unreferenced vertices may be not finite
  return result;
}

}  // namespace

SurfaceSamples::SurfaceSamples(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                               std::uint64_t area_points)
    : positions_(positions), triangles_(triangles), area_points_(area_points) {
  std::vector<char> used(positions.size(), 0);
  area_up_to_.reserve(triangles.size());
  double area = 0;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t.v) used[v] = 1;
    const Vec3d a = positions[t.v[0]], b = positions[t.v[1]], c = positions[t.v[2]];
    area += 0.5 * length(cross(b - a, c - a));
    area_up_to_.push_back(area);
  }
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) used_.push_back(v);
  if (!(area > 0)) area_points_ = 0;
}

Vec3d SurfaceSamples::point_in(const Triangle& triangle, std::uint64_t k) const {
  // Powers of the inverse of the plastic number, the root of x^3 = x + 1.
  constexpr double r1 = 0.7548776662466927, r2 = 0.5698402909980532;
  const auto fraction = [](double v) { return v - std::floor(v); };
  double u = fraction(0.5 + r1 * static_cast<double>(k)), v = fraction(0.5 + r2 * static_cast<double>(k));
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const Vec3d a = positions_[triangle.v[0]];
  return a + u * (positions_[triangle.v[1]] - a) + v * (positions_[triangle.v[2]] - a);
}

void SurfaceSamples::take(std::uint64_t begin, std::uint64_t end, std::vector<Vec3d>& out,
                          std::vector<std::uint32_t>* triangles) const {
  assert(!triangles || begin >= vertices());
  out.clear();
  if (triangles) triangles->clear();
  for (; begin < end && begin < vertices(); ++begin) out.push_back(positions_[used_[begin]]);
  if (begin >= end) return;
  const auto share = [&](std::uint64_t k) {
    return (static_cast<double>(k) + 0.5) / static_cast<double>(area_points_) * area_up_to_.back();
  };
  // The first triangle whose sum exceeds the share; the sums ascend, so the next point's triangle is not before it.
  auto at = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), share(begin - vertices()));
  for (std::uint64_t k = begin - vertices(); k < end - vertices(); ++k) {
    while (at != area_up_to_.end() && *at <= share(k)) ++at;
    if (at == area_up_to_.end()) --at;
    const auto triangle = static_cast<std::size_t>(at - area_up_to_.begin());
    out.push_back(point_in(triangles_[triangle], k));
    if (triangles) triangles->push_back(static_cast<std::uint32_t>(triangle));
  }
}

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
    throw InputError(describe("", "", "the extent of the meshes exceeds double precision", "scale them down"));
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

}  // namespace lodestone
