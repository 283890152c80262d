// Distances between meshes: building the search structure, and samples per second against it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hierarchy/construct/level_surface.h"
#include "core/mesh/generate.h"
#include "core/spatial/mesh_distance.h"
#include "core/spatial/surface_samples.h"
#include "core/spatial/triangle_bvh.h"
#ifdef LODESTONE_HAS_EMBREE
#include "bench/embree_points.h"
#endif

namespace lodestone {
namespace {

// The same surface for every number of triangles.
RawMesh torus(std::int64_t triangles) {
  return generate_mesh({.shape = Shape::torus, .triangles = static_cast<std::uint64_t>(triangles)});
}

void build_bvh(benchmark::State& state) {
  const RawMesh mesh = torus(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(TriangleBvh(mesh.positions, mesh.triangles));
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(mesh.triangles.size()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(build_bvh)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

// Samples of one triangulation against another one of the same surface, as for a level against its input.
void nearest_points(benchmark::State& state) {
  const ComparedPair pair = prepare_comparison(torus(state.range(0)), torus(state.range(1)));
  const TriangleBvh bvh(pair.mesh[1].positions, pair.mesh[1].triangles);
  const SurfaceSamples samples = samples_of(pair.mesh[0], {.area_points = 100'000});
  std::vector<double> squared(samples.size());
  for (auto _ : state)
    for (std::uint64_t begin = 0; begin < samples.size(); begin += sample_grain)
      measure_samples(samples, bvh, begin, std::min(begin + sample_grain, samples.size()), squared);
  const DirectedDistance distance = summarise(samples, squared, pair.scale);
  if (!(distance.max > 0 && distance.max < 0.01 * pair.diagonal)) state.SkipWithError("distances out of range");
  state.counters["samples/s"] =
      benchmark::Counter(static_cast<double>(samples.size()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(nearest_points)->Args({1'000'000, 900'000})->Args({1'000'000, 50'000})->Unit(benchmark::kMillisecond);

// A hierarchy of one level: the surface that errors are measured from.
class OneLevel {
 public:
  explicit OneLevel(const ComparedMesh& mesh) {
    for (const Vec3d p : mesh.positions) positions_.push_back(to_float(p));
    hierarchy_.levels.resize(1);
    hierarchy_.levels[0].cell_count = 1;
    hierarchy_.cells.resize(1);
    hierarchy_.cells[0].positions = positions_;
    hierarchy_.cells[0].triangles = mesh.triangles;
  }
  [[nodiscard]] LevelSurface surface() const {
    LevelSurface surface(hierarchy_, 0);
    surface.build_cell(CellRank(0));
    surface.build_rest();
    return surface;
  }

 private:
  std::vector<Vec3f> positions_;
  Hierarchy hierarchy_;
};

// The same queries by each structure, one after the other along the surface, each from the last one's answer. Vertices
// are those of floats for all of them. No timing without the distances of TriangleBvh, which tests compare with brute
// force.
ComparedPair float_pair(const benchmark::State& state) {
  ComparedPair pair = prepare_comparison(torus(state.range(0)), torus(state.range(1)));
  for (ComparedMesh& mesh : pair.mesh) {
    std::vector<Vec3f> rounded;  // in one loop a vertex comes out unrounded with g++ 12 -O3
    for (const Vec3d p : mesh.positions) rounded.push_back(to_float(p));
    for (std::size_t i = 0; i < rounded.size(); ++i) mesh.positions[i] = to_double(rounded[i]);
  }
  return pair;
}

template <class Nearest>
void query(benchmark::State& state, const ComparedMesh& from, const ComparedMesh& to, const Nearest& squared_distance) {
  const TriangleBvh reference(to.positions, to.triangles);
  double sum = 0, worst = 0;
  for (const Vec3d p : from.positions)
    worst =
        std::max(worst, std::abs(std::sqrt(squared_distance(p)) - std::sqrt(reference.nearest(p).squared_distance)));
  if (worst > 1e-14) state.SkipWithError("distances differ");
  for (auto _ : state) {
    sum = 0;
    for (const Vec3d p : from.positions) sum += std::sqrt(squared_distance(p));
  }
  state.counters["queries/s"] =
      benchmark::Counter(static_cast<double>(from.positions.size()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["mean_distance"] = sum / static_cast<double>(from.positions.size());
}

void query_triangle_bvh(benchmark::State& state) {
  const ComparedPair pair = float_pair(state);
  const TriangleBvh bvh(pair.mesh[1].positions, pair.mesh[1].triangles);
  std::uint32_t hint = TriangleBvh::no_hint;
  query(state, pair.mesh[0], pair.mesh[1], [&](Vec3d p) {
    const TriangleBvh::Nearest nearest = bvh.nearest(p, hint);
    hint = nearest.slot;
    return nearest.squared_distance;
  });
}

void query_level_surface(benchmark::State& state) {
  const ComparedPair pair = float_pair(state);
  const OneLevel level(pair.mesh[1]);
  const LevelSurface surface = level.surface();
  SurfaceItem hint;
  query(state, pair.mesh[0], pair.mesh[1], [&](Vec3d p) {
    const LevelSurface::Nearest nearest = surface.nearest(p, hint);
    hint = nearest.item;
    return nearest.squared_distance;
  });
}

#ifdef LODESTONE_HAS_EMBREE
void query_embree(benchmark::State& state) {
  const ComparedPair pair = float_pair(state);
  const EmbreePoints points(pair.mesh[1].positions, pair.mesh[1].triangles);
  std::uint32_t hint = 0;
  query(state, pair.mesh[0], pair.mesh[1], [&](Vec3d p) { return points.nearest(p, hint); });
}
#endif

void from_fine_to_coarse_and_back(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({200'000, 50'000})->Args({50'000, 200'000})->Args({1'000'000, 15'000})->Unit(benchmark::kMillisecond);
}
BENCHMARK(query_triangle_bvh)->Apply(from_fine_to_coarse_and_back);
BENCHMARK(query_level_surface)->Apply(from_fine_to_coarse_and_back);
#ifdef LODESTONE_HAS_EMBREE
BENCHMARK(query_embree)->Apply(from_fine_to_coarse_and_back);
#endif

}  // namespace
}  // namespace lodestone
