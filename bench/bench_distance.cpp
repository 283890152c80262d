// Distances between meshes: building the search structure, and samples per second against it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "core/distance/mesh_distance.h"
#include "core/mesh/generate.h"

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

}  // namespace
}  // namespace lodestone
