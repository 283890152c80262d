// The complete hierarchy, from a clean mesh to packed levels in memory: million input triangles per CPU second.
//
// Every timed build is verified afterwards, independently of the builder: a figure without it would mean nothing.
#include <benchmark/benchmark.h>

#include <string>

#include "core/hierarchy/verify/verify.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"

namespace lodestone {
namespace {

struct Input {
  Shape shape;
  bool shuffled = false;  // vertices and triangles in random order
};

IndexedMesh make_input(const Input& input, std::uint64_t triangles, Scheduler& scheduler) {
  RawMesh raw = generate_mesh({input.shape, triangles, 1});
  if (input.shuffled) {
    // Multiplication by a number coprime to the count visits everything once, far from where it was.
    const auto scatter = [](std::uint64_t i, std::uint64_t count) { return i * 0x9e37'79b1ull % count; };
    RawMesh mixed = raw;
    for (std::uint64_t i = 0; i < raw.triangles.size(); ++i)
      mixed.triangles[i] = raw.triangles[scatter(i, raw.triangles.size())];
    raw = std::move(mixed);
  }
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, scheduler);
}

void build(benchmark::State& state, Input input, const std::string& simplifier) {
  const auto scheduler = make_tbb_scheduler();
  const IndexedMesh mesh = make_input(input, static_cast<std::uint64_t>(state.range(0)), *scheduler);
  BuildConfig config;
  config.simplifier = simplifier;
  double cpu = 0;
  std::uint64_t stored = 0;
  bool valid = true;
  for (auto _ : state) {
    state.PauseTiming();
    IndexedMesh copy = mesh;
    BuildReport report;
    state.ResumeTiming();
    const Hierarchy h = build_hierarchy(std::move(copy), config, *scheduler, &report);
    state.PauseTiming();
    cpu += report.total.cpu_seconds;
    stored = 0;
    for (const Level& level : h.levels) stored += level.triangles;
    valid = valid && verify_hierarchy(h).valid();
    state.ResumeTiming();
  }
  if (!valid) state.SkipWithError("the hierarchy does not verify");
  const auto input_triangles = static_cast<double>(mesh.triangles.size());
  state.counters["Mtri/core-s"] = 1e-6 * input_triangles * static_cast<double>(state.iterations()) / cpu;
  state.counters["stored"] = static_cast<double>(stored) / input_triangles;
}

#define LODESTONE_BUILD_BENCH(name, ...)      \
  BENCHMARK_CAPTURE(build, name, __VA_ARGS__) \
      ->Arg(1'000'000)                        \
      ->Arg(4'000'000)                        \
      ->Unit(benchmark::kMillisecond)         \
      ->UseRealTime()

LODESTONE_BUILD_BENCH(sphere_quadric, Input{Shape::sphere}, "quadric");
LODESTONE_BUILD_BENCH(terrain_quadric, Input{Shape::terrain}, "quadric");
LODESTONE_BUILD_BENCH(sphere_shuffled_quadric, Input{Shape::sphere, true}, "quadric");
LODESTONE_BUILD_BENCH(sphere_cluster, Input{Shape::sphere}, "cluster");

}  // namespace
}  // namespace lodestone
