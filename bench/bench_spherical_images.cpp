// Cost of octahedral images: the map of points between square and sphere, unfolding.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <random>
#include <vector>

#include "core/mesh/generate.h"
#include "core/spherical/octahedron/octahedral_map.h"
#include "core/spherical/octahedron/sphere_raster.h"
#include "core/spherical/octahedron/unfold.h"

namespace {

using namespace lodestone;
using namespace lodestone::spherical;

constexpr std::size_t points = 4096;

// A generated sphere, and the directions of its vertices from its centre.
struct Subject {
  RawMesh mesh = generate_mesh({Shape::sphere, 200'000, 1});
  std::vector<Vec3d> directions;

  Subject() {
    for (const Vec3d& p : mesh.positions) {
      const Vec3d d = p - Vec3d{0.5, 0.5, 0.5};
      directions.push_back((1 / length(d)) * d);
    }
  }
};
const Subject& subject() {
  static const Subject only;
  return only;
}

void square_to_sphere(benchmark::State& state) {
  std::mt19937_64 random(1);
  const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<SquarePoint> from(points);
  for (SquarePoint& p : from) p = {number(), number()};
  std::vector<Vec3d> to(points);
  for (auto _ : state) {
    for (std::size_t i = 0; i < points; ++i) to[i] = direction_of(from[i]);
    benchmark::DoNotOptimize(to.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points));
}

void sphere_to_square(benchmark::State& state) {
  const std::vector<Vec3d>& from = subject().directions;
  std::vector<SquarePoint> to(points);
  for (auto _ : state) {
    for (std::size_t i = 0; i < points; ++i) to[i] = square_point(from[i]);
    benchmark::DoNotOptimize(to.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points));
}

// Items are triangles.
void unfolding(benchmark::State& state) {
  const Subject& s = subject();
  for (auto _ : state) benchmark::DoNotOptimize(unfold(s.mesh.triangles, s.directions));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.mesh.triangles.size()));
}

// Items are samples of 2048 x 2048, all steps included.
void covering(benchmark::State& state) {
  const Subject& s = subject();
  constexpr std::uint32_t n = 2048;
  SampleTile tile;
  for (auto _ : state) {
    SphereRaster raster(s.mesh.triangles, s.directions, {n, SampleGrid::Placing::in_cells});
    raster.prepare();
    for (std::size_t k = 0; k < raster.tile_count(); ++k) {
      raster.cover(k, tile);
      benchmark::DoNotOptimize(tile.triangle.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t{n} * n);
}

BENCHMARK(square_to_sphere);
BENCHMARK(sphere_to_square);
BENCHMARK(covering)->Unit(benchmark::kMillisecond);
BENCHMARK(unfolding)->Unit(benchmark::kMillisecond);

}  // namespace
