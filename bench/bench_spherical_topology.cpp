// Closing handles: seconds beside the length of the loops that are cut.
//
// Argument: the slack of the balls in percent; 0 is the exact greedy choice. Counters: triangles, components, genus (of
// all components together) and loops (their total length, where the longest extent of the model is 1). Times are CPU
// times of one thread, from the mesh in memory to the spheres, which are verified afterwards.
#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "core/mesh/solids.h"
#include "core/spherical/topology/make_spheres.h"

namespace {

using namespace lodestone;

const IndexedMesh& subject(const std::string& name) {
  static std::map<std::string, IndexedMesh> meshes;
  const auto [at, is_new] = meshes.try_emplace(name);
  if (!is_new) return at->second;
  if (name == "rings") at->second = five_rings(131);
  if (name == "truss") at->second = truss(90, 4);
  if (name == "foam") at->second = foam(58);
  return at->second;
}

void close_handles(benchmark::State& state, const std::string& name) {
  const IndexedMesh& mesh = subject(name);
  const spherical::HandleConfig config{0.01 * static_cast<double>(state.range(0))};
  spherical::Spheres spheres;
  for (auto _ : state) benchmark::DoNotOptimize(spheres = spherical::make_spheres(mesh, config));
  for (const spherical::Surface& surface : spheres.surfaces)
    if (!is_sphere(surface)) state.SkipWithError("a component is not a sphere");
  const spherical::TopologyReport& report = spheres.report;
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["components"] = static_cast<double>(report.components);
  state.counters["genus"] = static_cast<double>(report.handles);
  state.counters["loops"] = report.loops.total / mesh.transform.scale;
}

void slacks(benchmark::internal::Benchmark* benchmark) {
  benchmark->Unit(benchmark::kMillisecond);
  for (const int percent : {100, 50, 25, 0}) benchmark->Arg(percent);
}

BENCHMARK_CAPTURE(close_handles, rings, "rings")->Apply(slacks);
BENCHMARK_CAPTURE(close_handles, truss, "truss")->Apply(slacks);
BENCHMARK_CAPTURE(close_handles, foam, "foam")->Apply(slacks);

}  // namespace
